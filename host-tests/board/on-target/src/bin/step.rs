//! The estimator's step and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of six segments, as the firmware has it, 1000 samples each.
#![no_std]
#![no_main]

use on_target_tests::step::{TABLES, TestedEstimator, alone, steps};

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SIX: TestedEstimator<6> = TestedEstimator::const_new(&TABLES[2]);
    alone(|| steps(SIX))
}
