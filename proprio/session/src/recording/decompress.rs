//! Decompression of chunks.

use std::borrow::Cow;
use std::io::Read;

use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;

/// Compression of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compression {
    None,
    Zstd,
    Lz4,
}

impl Compression {
    /// The compression of this name in a chunk's header.
    pub fn of(name: &[u8]) -> Option<Self> {
        match name {
            b"" => Some(Self::None),
            b"zstd" => Some(Self::Zstd),
            b"lz4" => Some(Self::Lz4),
            _ => None,
        }
    }

    /// The content of a chunk, `size` bytes long; `None` where it has another length or cannot be decompressed.
    pub fn decompress(self, data: &[u8], size: u64) -> Option<Cow<'_, [u8]>> {
        let content = match self {
            Self::None => Cow::Borrowed(data),
            Self::Zstd => Cow::Owned(frames(data, size)?),
            Self::Lz4 => Cow::Owned(read(FrameDecoder::new(data), size)?),
        };
        (content.len() as u64 == size).then_some(content)
    }
}

/// The content of Zstandard frames, one after the other.
fn frames(mut data: &[u8], size: u64) -> Option<Vec<u8>> {
    let mut content = Vec::new();
    while !data.is_empty() && content.len() as u64 <= size {
        content.extend(read(StreamingDecoder::new(&mut data).ok()?, size)?);
    }
    Some(content)
}

/// All bytes of a source, or one more than `size`.
fn read(source: impl Read, size: u64) -> Option<Vec<u8>> {
    let mut content = Vec::new();
    source.take(size.saturating_add(1)).read_to_end(&mut content).ok()?;
    Some(content)
}
