//! Frames: `[version][topic][sequence, 2][body][CRC-32, 4]`, COBS-encoded and ended by a zero.
//!
//! A frame is short enough for one block of COBS (Cheshire and Baker, 1999): one byte in front, and each zero replaced by
//! the distance to the next. That is done in place, in the buffer that is sent or was received.

use crc::{CRC_32_ISO_HDLC, Crc};

use crate::constants::{MAX_FRAME, PROTOCOL_VERSION};
use crate::decode_error::DecodeError;
use crate::payload::Payload;

/// The CRC-32 of zip and Ethernet. Its table takes 1 KiB of flash; without it a byte costs 64 instructions, not 8.
static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why a message was not encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EncodeError {
    /// The buffer is shorter than the frame, or the frame longer than [`MAX_FRAME`].
    #[error("the frame does not fit in the buffer: give it {MAX_FRAME} bytes")]
    Room,
}

/// Makes frames of one side's messages and numbers them.
///
/// A frame that was encoded and then not sent counts as lost at the other side. See the [crate's example](crate).
#[derive(Debug)]
pub struct Encoder {
    version: u8,
    sequence: u16,
}

impl Default for Encoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Encoder {
    /// An encoder whose first frame has the number 0.
    #[must_use]
    pub const fn new() -> Self {
        Self::for_version(PROTOCOL_VERSION)
    }

    /// An encoder for a receiver of this version of the protocol.
    #[must_use]
    pub const fn for_version(version: u8) -> Self {
        Self { version, sequence: 0 }
    }

    /// Encodes a message into `buffer` and returns the frame, its zero included; [`MAX_FRAME`] bytes hold any.
    ///
    /// # Errors
    /// [`EncodeError::Room`] where the frame does not fit, or the receiver's version has no such message; it has then used up no
    /// number.
    pub fn encode<'b, P: Payload>(&mut self, payload: &P, buffer: &'b mut [u8]) -> Result<&'b [u8], EncodeError> {
        let frame = frame(self.version, self.sequence, payload, buffer).ok_or(EncodeError::Room)?;
        self.sequence = self.sequence.wrapping_add(1);
        Ok(frame)
    }
}

fn frame<'b, P: Payload>(version: u8, sequence: u16, payload: &P, buffer: &'b mut [u8]) -> Option<&'b [u8]> {
    let (_, content) = buffer.split_first_mut()?;
    let length = write_content(version, sequence, payload, content)?;
    let frame = buffer.get_mut(..length + 2).filter(|frame| frame.len() <= MAX_FRAME)?;
    let (end, block) = frame.split_last_mut()?;
    stuff(block);
    *end = 0;
    Some(frame)
}

/// Writes a frame's content, from the version to the CRC, and returns its length.
fn write_content<P: Payload>(version: u8, sequence: u16, payload: &P, content: &mut [u8]) -> Option<usize> {
    let (header, body) = content.split_first_chunk_mut()?;
    let [low, high] = sequence.to_le_bytes();
    *header = [version, payload.topic(), low, high];
    let checked = header.len() + payload.write(version, body)?;
    let (content, rest) = content.split_at_mut_checked(checked)?;
    let crc = rest.first_chunk_mut()?;
    *crc = CRC.checksum(content).to_le_bytes();
    Some(checked + crc.len())
}

/// An undamaged frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame<'b> {
    /// Version of the protocol.
    pub version: u8,
    /// Number of its kind of message.
    pub topic: u8,
    /// Its own number.
    pub sequence: u16,
    /// Its message.
    pub body: &'b [u8],
}

impl<'b> Frame<'b> {
    /// Opens the bytes between two zeros, in place.
    ///
    /// `versions` are those of which the body can be read.
    pub fn open(block: &'b mut [u8], versions: &[u8]) -> Result<Self, DecodeError> {
        if !unstuff(block) {
            return Err(DecodeError::Damaged);
        }
        let content = block.split_first().and_then(|(_, content)| content.split_last_chunk());
        let (content, crc) = content.ok_or(DecodeError::Damaged)?;
        if CRC.checksum(content) != u32::from_le_bytes(*crc) {
            return Err(DecodeError::Damaged);
        }
        match *content {
            [version, ..] if !versions.contains(&version) => Err(DecodeError::Version(version)),
            [version, topic, low, high, ref body @ ..] => {
                Ok(Self { version, topic, sequence: u16::from_le_bytes([low, high]), body })
            }
            _ => Err(DecodeError::Damaged),
        }
    }
}

/// Replaces the first byte, which is free, and each zero by the distance to the next zero or the end.
fn stuff(block: &mut [u8]) {
    if let Some(free) = block.first_mut() {
        *free = 0;
    }
    let mut distance = 1;
    for byte in block.iter_mut().rev() {
        if *byte == 0 {
            *byte = distance;
            distance = 0;
        }
        distance += 1;
    }
}

/// Undoes [`stuff`]; false where the distances do not meet the block's end.
fn unstuff(block: &mut [u8]) -> bool {
    let mut distance = 0;
    for byte in block.iter_mut() {
        if distance == 0 {
            distance = *byte;
            *byte = 0;
        }
        distance = distance.saturating_sub(1);
    }
    distance == 0
}
