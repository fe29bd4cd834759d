//! Frames of any body with the right checksum, which a fuzzer does not find, and a second decoder to compare with.

use telemetry::{DecodeError, Encoder, MAX_FRAME, Payload};

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

/// Content of the frame in the bytes before a zero, from its version to its body, by other crates than `telemetry` has. `None`
/// for a damaged frame.
pub fn reference(block: &[u8]) -> Option<Vec<u8>> {
    if block.len() >= MAX_FRAME {
        return None;
    }
    let mut content = [0; MAX_FRAME];
    let length = cobs::decode(block, &mut content).ok()?.frame_size();
    let (content, crc) = content[..length].split_last_chunk::<CRC>()?;
    (crc32fast::hash(content).to_le_bytes() == *crc).then(|| content.to_vec())
}

/// The result that a decoder must have for the content of a frame.
///
/// # Errors
/// Those of the decoder; of a damaged frame [`DecodeError::Damaged`], which stands for [`DecodeError::Oversize`], too.
pub fn expected<P: Payload>(content: Option<&[u8]>) -> Result<P, DecodeError> {
    match content {
        Some([version, ..]) if !P::VERSIONS.contains(version) => Err(DecodeError::Version(*version)),
        Some([version, topic, _, _, body @ ..]) => P::read(*version, *topic, body),
        _ => Err(DecodeError::Damaged),
    }
}
