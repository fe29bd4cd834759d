//! Frames of any body with the right checksum, which a fuzzer does not find, and a second decoder to compare with.

use telemetry::{DecodeError, Encoder, MAX_FRAME, Payload};

/// Bytes of a frame's content before its body: version, topic and number.
const HEADER: usize = 4;

/// Bytes of a frame's checksum.
const CRC: usize = 4;

/// Any bytes as the body of a frame.
struct Body<'b> {
    topic: u8,
    bytes: &'b [u8],
}

impl Payload for Body<'_> {
    const VERSIONS: &'static [u8] = &[];

    fn topic(&self) -> u8 {
        self.topic
    }

    fn write(&self, _: u8, body: &mut [u8]) -> Option<usize> {
        body.get_mut(..self.bytes.len())?.copy_from_slice(self.bytes);
        Some(self.bytes.len())
    }

    fn read(_: u8, topic: u8, _: &[u8]) -> Result<Self, DecodeError> {
        Err(DecodeError::Topic(topic))
    }
}

/// A frame with this body, its zero included; `None` if it does not fit.
pub fn frame_of(version: u8, topic: u8, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut buffer = [0; MAX_FRAME];
    let frame = Encoder::for_version(version).encode(&Body { topic, bytes }, &mut buffer).ok()?;
    Some(frame.to_vec())
}

/// Content of an undamaged frame: version, topic and body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Content {
    /// Version of the protocol.
    pub version: u8,
    /// Number of its kind of message.
    pub topic: u8,
    /// Its message.
    pub body: Vec<u8>,
}

/// Decodes the bytes before a zero by other crates than `telemetry` does. `None` for a damaged frame.
pub fn reference(block: &[u8]) -> Option<Content> {
    if block.len() >= MAX_FRAME {
        return None;
    }
    let mut content = [0; MAX_FRAME];
    let length = cobs::decode(block, &mut content).ok()?.frame_size();
    let (checked, crc) = content[..length].split_at_checked(length.checked_sub(CRC)?)?;
    if crc32fast::hash(checked).to_le_bytes() != crc || checked.len() < HEADER {
        return None;
    }
    let (header, body) = checked.split_at(HEADER);
    Some(Content { version: header[0], topic: header[1], body: body.to_vec() })
}
