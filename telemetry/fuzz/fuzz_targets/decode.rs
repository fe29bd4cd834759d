//! Decodes arbitrary bytes: neither side may panic, and each accepted payload must encode again.
//!
//! In the folder `telemetry`: `cargo +nightly fuzz run decode`.
#![no_main]

use std::fmt::Debug;

use libfuzzer_sys::fuzz_target;
use telemetry::{Decoder, Encoder, MAX_FRAME, Message, Payload, Request};

fuzz_target!(|bytes: &[u8]| {
    receive::<Message>(bytes);
    receive::<Request>(bytes);
});

fn receive<P: Payload + Clone + PartialEq + Debug>(bytes: &[u8]) {
    let mut decoder = Decoder::<P>::new();
    let mut frames = 0;
    for payload in bytes.iter().filter_map(|&byte| decoder.push(byte)) {
        frames += 1;
        if let Ok(payload) = payload {
            repeat(&payload);
        }
    }
    let counts = decoder.counts();
    assert_eq!(counts.received + counts.damaged + counts.wrong_version + counts.unknown, frames);

    // A fuzzer does not find a CRC-32: it writes bodies behind their topic.
    if let Some((&topic, body)) = bytes.split_first() {
        for version in P::VERSIONS {
            if let Ok(payload) = P::read(*version, topic, body) {
                repeat(&payload);
            }
        }
    }
}

fn repeat<P: Payload + Clone + PartialEq + Debug>(payload: &P) {
    let mut buffer = [0; MAX_FRAME];
    let frame = Encoder::new().encode(payload, &mut buffer).expect("every message fits");
    let mut decoder = Decoder::<P>::new();
    let again = frame.iter().find_map(|&byte| decoder.push(byte));
    assert_eq!(again.as_ref(), Some(&Ok(payload.clone())));
}
