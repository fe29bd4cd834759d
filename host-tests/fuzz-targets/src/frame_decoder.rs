//! Frames of both directions: `telemetry`'s decoder on the host and on the board.
//!
//! The first byte is the topic of a body, which follows it; or it is [`STREAM`], and bytes as they are received follow.

use std::fmt::Debug;

use telemetry::{DecodeError, Decoder, Encoder, MAX_FRAME, Message, Payload, Request, topic};

use crate::frames::{expected, frame_of, reference};

/// First byte before received bytes; no topic has this number.
const STREAM: u8 = 0xFF;

/// Lowest topic of a host's messages.
const FIRST_OF_HOST: u8 = topic::REQUEST;

/// Decodes received bytes, or the frame of a body.
///
/// # Panics
/// Where the decoder accepts a frame that another decoder refuses, or the other way round; where its counts are not those of its
/// results; and where an accepted message does not encode to a frame that decodes to it.
pub fn frame_decoder(bytes: &[u8]) {
    let Some((&first, rest)) = bytes.split_first() else { return };
    if first == STREAM {
        receive::<Message>(rest);
        receive::<Request>(rest);
    } else if first < FIRST_OF_HOST {
        read::<Message>(first, rest);
    } else {
        read::<Request>(first, rest);
    }
}

/// Decodes received bytes, and compares with the other decoder frame by frame.
fn receive<P: Payload + PartialEq + Debug>(bytes: &[u8]) {
    let mut decoder = Decoder::<P>::new();
    let mut frames = 0;
    let mut block = 0;
    for (place, byte) in bytes.iter().enumerate() {
        let result = decoder.push(*byte);
        if *byte != 0 {
            assert_eq!(result, None, "a frame ends with its zero");
            continue;
        }
        let content = reference(&bytes[block..place]);
        let is_empty = block == place;
        block = place + 1;
        let Some(result) = result else {
            assert!(is_empty, "each block of bytes is a result");
            continue;
        };
        frames += 1;
        let is_oversize = result == Err(DecodeError::Oversize);
        let result = if is_oversize { Err(DecodeError::Damaged) } else { result };
        assert_eq!(result, expected(content.as_deref()));
        result.iter().for_each(repeat);
    }
    let counts = decoder.counts();
    assert_eq!(counts.received + counts.damaged + counts.wrong_version + counts.unknown, frames);
}

/// Reads a body of each version, alone and in its frame.
fn read<P: Payload + PartialEq + Debug>(topic: u8, body: &[u8]) {
    for version in P::VERSIONS {
        let result = P::read(*version, topic, body);
        if let Ok(payload) = &result {
            assert_eq!(payload.topic(), topic);
            repeat(payload);
        }
        if let Some(frame) = frame_of(*version, topic, body) {
            let mut decoder = Decoder::<P>::new();
            assert_eq!(frame.iter().find_map(|byte| decoder.push(*byte)), Some(result));
        }
    }
}

/// Encodes a payload, and compares what is decoded.
fn repeat<P: Payload + PartialEq + Debug>(payload: &P) {
    let mut buffer = [0; MAX_FRAME];
    let frame = Encoder::new().encode(payload, &mut buffer).expect("every message fits");
    let mut decoder = Decoder::<P>::new();
    let again = frame.iter().find_map(|&byte| decoder.push(byte));
    assert_eq!(again.as_ref().and_then(|again| again.as_ref().ok()), Some(payload));
}
