//! The estimator's step with the bias filter and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For an arm of six segments with curves, hysteresis, contact and uncertainty, as the firmware has it, 1000 samples that move and
//! 3000 at rest. The estimator is a static: the stack has no room for it and the step.
#![no_std]
#![no_main]

use on_target_tests::step::{BIAS_FILTER_TABLES, TestedEstimator, alone, steps_with_uncertainty};

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SIX: TestedEstimator<6> = TestedEstimator::const_new(&BIAS_FILTER_TABLES[0]);
    alone(|| steps_with_uncertainty(SIX))
}
