//! Tables and arm descriptions.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::table_toml(bytes));
