//! The estimator's step with the bias filter and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of 6 and 8 segments with curves, memory, contact and uncertainty, 1000 samples each that move and 3000 at rest.
#![no_std]
#![no_main]

use board_probe::step::{BIAS_FILTER_TABLES, ProbedEstimator, alone, steps_with_uncertainty};

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SIX: ProbedEstimator<6> = ProbedEstimator::const_new(&BIAS_FILTER_TABLES[0]);
    static mut EIGHT: ProbedEstimator<8> = ProbedEstimator::const_new(&BIAS_FILTER_TABLES[1]);
    alone(|| {
        steps_with_uncertainty(SIX);
        steps_with_uncertainty(EIGHT);
    })
}
