//! The table in the board's flash.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::table_page(bytes));
