//! A slot of the flash: a page with the header, then the body, image and source.
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 0 | 4 | [`MAGIC`] |
//! | 4 | 2 | format version, [`FORMAT`] |
//! | 6 | 2 | 0 |
//! | 8 | 4 | generation |
//! | 12 | 4 | length of the image, bytes |
//! | 16 | 4 | length of the source, bytes |
//! | 20 | 4 | CRC-32 of the body |
//! | 24 | 4 | CRC-32 of bytes 0 to 23 |
//! | 256 | | body |
//!
//! All numbers are little-endian; the CRC is that of zip and Ethernet.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// First bytes of a slot in use.
pub const MAGIC: [u8; 4] = *b"PTab";

/// Version of the image's format. It changes with every change of the estimator's configuration types
/// and of the wiring's rows.
pub const FORMAT: u16 = 2;

/// Size of a slot, bytes.
pub const SLOT_BYTES: usize = 32 * 1024;

/// Size of a flash page, bytes.
pub const PAGE_BYTES: usize = 256;

/// Length of the header, bytes.
pub(crate) const HEADER_BYTES: usize = 28;

const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// CRC-32 of a body, given in parts.
pub fn body_crc<'b>(parts: impl IntoIterator<Item = &'b [u8]>) -> u32 {
    let mut digest = CRC.digest();
    for part in parts {
        digest.update(part);
    }
    digest.finalize()
}

/// Header of a stored table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Number of the table: each stored one has a higher number than the one before it.
    pub generation: u32,
    /// Length of the image, bytes.
    pub image_bytes: u32,
    /// Length of the source, bytes.
    pub source_bytes: u32,
    /// CRC-32 of image and source.
    pub crc: u32,
}

/// State of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlotState {
    /// It was erased, or never written.
    Empty,
    /// A whole table.
    Whole(Header),
    /// A table of another format version.
    Foreign(u16),
    /// A checksum is wrong.
    Damaged,
}

impl Header {
    /// The header's bytes in flash.
    pub(crate) fn to_bytes(self) -> [u8; HEADER_BYTES] {
        let [m0, m1, m2, m3] = MAGIC;
        let [f0, f1] = FORMAT.to_le_bytes();
        let mut bytes = [0; HEADER_BYTES];
        let fields = [self.generation, self.image_bytes, self.source_bytes, self.crc];
        let words = [[m0, m1, m2, m3], [f0, f1, 0, 0]].into_iter().chain(fields.map(u32::to_le_bytes));
        let (chunks, _) = bytes.as_chunks_mut::<4>();
        chunks.iter_mut().zip(words).for_each(|(chunk, word)| *chunk = word);
        if let Some((own, crc)) = bytes.split_last_chunk_mut::<4>() {
            *crc = body_crc([&*own]).to_le_bytes();
        }
        bytes
    }

    /// Length of the body, bytes.
    pub(crate) fn body_bytes(self) -> usize {
        self.image_bytes.saturating_add(self.source_bytes) as usize
    }
}

impl SlotState {
    /// Examines a slot, with the checksum over all of it.
    pub fn of(slot: &[u8]) -> Self {
        let Some((own, rest)) = slot.split_at_checked(HEADER_BYTES - 4) else { return Self::Empty };
        if slot.iter().take(HEADER_BYTES).all(|byte| *byte == 0xFF) {
            return Self::Empty;
        }
        let crc = rest.first_chunk().copied().map(u32::from_le_bytes);
        let (words, _) = own.as_chunks::<4>();
        let &[magic, [f0, f1, ..], generation, image_bytes, source_bytes, body] = words else { return Self::Damaged };
        if crc != Some(body_crc([own])) || magic != MAGIC {
            return Self::Damaged;
        }
        let format = u16::from_le_bytes([f0, f1]);
        if format != FORMAT {
            return Self::Foreign(format);
        }
        let [generation, image_bytes, source_bytes, crc] =
            [generation, image_bytes, source_bytes, body].map(u32::from_le_bytes);
        let header = Header { generation, image_bytes, source_bytes, crc };
        let body = slot.get(PAGE_BYTES..).and_then(|body| body.get(..header.body_bytes()));
        match body {
            Some(body) if body_crc([body]) == crc => Self::Whole(header),
            _ => Self::Damaged,
        }
    }
}
