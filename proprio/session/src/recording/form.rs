//! The form of MCAP records, and the check of a record by it.

use std::borrow::Cow;

use mcap::records::op;

use super::decompress::Compression;

/// Bytes before a record's body: its opcode and its length.
pub const HEAD: usize = 9;

/// Longest record that is read, bytes; a longer one has a damaged length.
pub const MAX_RECORD: u64 = 1 << 28;

/// Shortest header of a chunk, bytes: that of one without compression.
pub const CHUNK_HEADER: usize = 40;

/// Longest name of a compression, bytes.
const MAX_NAME: usize = 4;

/// Longest header of a chunk, bytes.
pub const MAX_CHUNK_HEADER: usize = CHUNK_HEADER + MAX_NAME;

/// Header of a chunk.
#[derive(Debug, Clone, Copy)]
pub struct ChunkForm {
    pub compression: Compression,
    /// Bytes of this header.
    pub header: usize,
    /// Length of the content, bytes.
    pub content: u64,
    /// Length of the data in the file, bytes.
    pub data: u64,
    /// Checksum of the content; 0 where it has no checksum.
    pub crc: u32,
}

impl ChunkForm {
    /// Reads a header; `None` where no chunk has such a one.
    pub fn of(body: &[u8]) -> Option<Self> {
        let name_length = u32_at(body, 28)? as usize;
        if name_length > MAX_NAME {
            return None;
        }
        let compression = Compression::of(body.get(32..32 + name_length)?)?;
        let (content, crc, data) = (u64_at(body, 16)?, u32_at(body, 24)?, u64_at(body, 32 + name_length)?);
        Some(Self { compression, header: CHUNK_HEADER + name_length, content, data, crc })
    }

    /// The records in a chunk with this data; `None` where the data is damaged.
    pub fn records<'d>(&self, data: &'d [u8]) -> Option<Cow<'d, [u8]>> {
        let is_raw = self.compression == Compression::None;
        let size = if is_raw { data.len() as u64 } else { self.content };
        let records =
            Some(size).filter(|size| *size <= MAX_RECORD).and_then(|size| self.compression.decompress(data, size))?;
        let has_crc = self.crc != 0;
        let is_whole = if has_crc { crc32fast::hash(&records) == self.crc } else { size == self.content };
        (is_whole && is_chain(&records)).then_some(records)
    }

    /// The data's lengths that the header and the record's length allow: they differ where one of them is damaged.
    pub fn data_lengths(&self, record_length: u64) -> [Option<u64>; 3] {
        let of_record = record_length.checked_sub(self.header as u64).filter(|length| *length != self.data);
        let is_raw =
            self.compression == Compression::None && ![Some(self.data), of_record].contains(&Some(self.content));
        [Some(self.data), of_record, is_raw.then_some(self.content)]
            .map(|length| length.filter(|length| *length <= MAX_RECORD))
    }
}

/// Opcode and length of a record.
pub fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    Some((*bytes.first()?, u64_at(bytes, 1)?))
}

/// Opcode and body of the first record, and the bytes behind it; `None` where they are fewer than its length.
pub fn split_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (opcode, length) = head(bytes)?;
    let (body, behind) = bytes[HEAD..].split_at_checked(usize::try_from(length).ok()?)?;
    Some((opcode, body, behind))
}

/// The opcode of a record's body: `opcode`, or where that does not fit the body, one that differs in one bit and does. In a
/// file with chunks, a message outside of them is the least likely.
pub fn opcode_of(opcode: u8, body: &[u8], is_chunked: bool) -> Option<u8> {
    let is_unlikely = opcode == op::MESSAGE && is_chunked;
    let flipped = (0..8).map(|bit| opcode ^ 1 << bit).filter(|opcode| *opcode != op::MESSAGE);
    let first = Some(opcode).filter(|_| !is_unlikely);
    first.into_iter().chain(flipped).chain([opcode]).find(|opcode| fits(*opcode, body))
}

/// True where a body has the form of such a record. Chunks are checked by [`ChunkForm`].
pub fn fits(opcode: u8, body: &[u8]) -> bool {
    match opcode {
        op::MESSAGE => body.len() >= 22,
        op::ATTACHMENT => attachment_fits(body),
        _ => own_length(opcode, body) == Some(body.len()),
    }
}

/// True where a body is certainly that of such a record, which zeros or the bytes of a chunk are not.
pub fn fits_surely(opcode: u8, body: &[u8]) -> bool {
    fits(opcode, body)
        && match opcode {
            op::MESSAGE_INDEX => body.len() >= 22,
            op::METADATA => u32_at(body, 0) != Some(0) && mcap::parse_record(opcode, body).is_ok(),
            op::ATTACHMENT => !body.ends_with(&[0; 4]),
            _ => true,
        }
}

/// True where the lengths and the checksum of an attachment are right.
fn attachment_fits(body: &[u8]) -> bool {
    let Some(length) = own_length(op::ATTACHMENT, body).filter(|length| *length == body.len()) else { return false };
    let crc = u32_at(body, length - 4);
    crc == Some(0) || crc == Some(crc32fast::hash(&body[..length - 4]))
}

/// Length of a body by the lengths of its parts, bytes; `None` where it is too short or has a part without a length.
pub fn own_length(opcode: u8, body: &[u8]) -> Option<usize> {
    // The place behind a part that begins with its length: a string, a map, bytes.
    let behind = |at: usize| (u32_at(body, at)? as usize).checked_add(at + 4);
    match opcode {
        op::HEADER | op::METADATA => behind(behind(0)?),
        op::SCHEMA => behind(behind(behind(2)?)?),
        op::CHANNEL => behind(behind(behind(4)?)?),
        op::MESSAGE_INDEX => behind(2).filter(|end| (end - 6).is_multiple_of(16)),
        op::CHUNK_INDEX => behind(behind(32)? + 8)?.checked_add(16),
        op::ATTACHMENT => {
            let at = behind(behind(16)?)?;
            usize::try_from(u64_at(body, at)?).ok()?.checked_add(at + 12)
        }
        op::ATTACHMENT_INDEX => behind(behind(40)?),
        op::STATISTICS => behind(42),
        op::METADATA_INDEX => behind(16),
        op::SUMMARY_OFFSET => Some(17),
        op::DATA_END => Some(4),
        op::FOOTER => Some(20),
        _ => None,
    }
}

/// True where records follow each other in `content` from its begin to its end.
pub fn is_chain(content: &[u8]) -> bool {
    let mut rest = content;
    while !rest.is_empty() {
        let Some((opcode, body, behind)) = split_record(rest) else { return false };
        if matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) && !fits(opcode, body) {
            return false;
        }
        rest = behind;
    }
    true
}

pub fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
}

pub fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}
