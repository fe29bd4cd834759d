//! The estimator's step with the bias filter and nothing else, as `bias_filter` has it, for an arm of eight segments.
#![no_std]
#![no_main]

use on_target_tests::step::{BIAS_FILTER_TABLES, TestedEstimator, alone, steps_with_uncertainty};

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut EIGHT: TestedEstimator<8> = TestedEstimator::const_new(&BIAS_FILTER_TABLES[1]);
    alone(|| steps_with_uncertainty(EIGHT))
}
