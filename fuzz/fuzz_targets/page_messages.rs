//! Messages of the live page.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| fuzz_targets::page_messages(bytes));
