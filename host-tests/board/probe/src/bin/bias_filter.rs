//! The estimator's step with the bias filter and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For an arm of six segments with curves, memory, contact and uncertainty, as the firmware has it, 1000 samples that move and
//! 3000 at rest.
#![no_std]
#![no_main]

use board_probe::step::{BIAS_FILTER_TABLES, ProbedEstimator, alone, steps_with_uncertainty};

#[cortex_m_rt::entry]
fn main() -> ! {
    let [six, _] = &BIAS_FILTER_TABLES;
    alone(|| steps_with_uncertainty(&mut ProbedEstimator::<6>::const_new(six)))
}
