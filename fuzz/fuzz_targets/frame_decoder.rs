//! Frames of the serial line, both directions.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::frame_decoder(bytes));
