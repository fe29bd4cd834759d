//! The estimator's step and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of six segments, as the firmware has it, 1000 samples each.
#![no_std]
#![no_main]

use on_target_tests::step::{TABLES, alone, steps};

#[cortex_m_rt::entry]
fn main() -> ! {
    let [_, _, six, _] = &TABLES;
    alone(|| steps::<6>(six))
}
