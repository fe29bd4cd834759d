//! Bodies of the fuzz targets: each takes any bytes, and panics where an invariant of their reader does not hold.
//!
//! `fuzz/` runs them under libFuzzer, and the tests of this crate run them over the seeds in `fuzz/corpus`, without a fuzzer.

mod frame_decoder;
mod frames;

pub use frame_decoder::frame_decoder;
