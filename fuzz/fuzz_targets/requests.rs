//! A host's requests, as the board receives them.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::requests(bytes));
