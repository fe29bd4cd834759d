//! Properties of the protocol that board and host rely on.

mod budget;
mod counts;
mod estimator;
mod frames;
mod noise;
mod round_trip;
mod values;

use telemetry::{DecodeError, Decoder, Encoder, MAX_FRAME, Payload};

/// The frame of a message.
fn encode(encoder: &mut Encoder, payload: &impl Payload) -> Vec<u8> {
    encoder.encode(payload, &mut [0; MAX_FRAME]).expect("MAX_FRAME bytes hold any message").to_vec()
}

/// Results of decoding these bytes.
fn decode<P: Payload>(decoder: &mut Decoder<P>, bytes: &[u8]) -> Vec<Result<P, DecodeError>> {
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
}

/// A frame put together by others' crates, from the layout in `docs/reference/protocol.md`.
fn frame_by_hand(version: u8, topic: u8, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut content = vec![version, topic];
    content.extend(sequence.to_le_bytes());
    content.extend(body);
    content.extend(crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&content).to_le_bytes());
    block_by_hand(&content)
}

/// COBS of these bytes, and a zero.
fn block_by_hand(content: &[u8]) -> Vec<u8> {
    let mut block = vec![0; cobs::max_encoding_length(content.len())];
    let length = cobs::encode(content, &mut block);
    block.truncate(length);
    block.push(0);
    block
}
