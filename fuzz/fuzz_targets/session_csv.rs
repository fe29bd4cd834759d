//! Sessions as CSV.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::session_csv(bytes));
