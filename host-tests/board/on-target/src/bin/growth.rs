//! The estimator's step and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of 1, 2, 6 and 8 segments, 1000 samples each. The stack has no room for the estimators of the longer arms.
#![no_std]
#![no_main]

use on_target_tests::step::{TABLES, TestedEstimator, alone, steps};

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SIX: TestedEstimator<6> = TestedEstimator::const_new(&TABLES[2]);
    static mut EIGHT: TestedEstimator<8> = TestedEstimator::const_new(&TABLES[3]);
    alone(|| {
        steps(&mut TestedEstimator::<1>::const_new(&TABLES[0]));
        steps(&mut TestedEstimator::<2>::const_new(&TABLES[1]));
        steps(SIX);
        steps(EIGHT);
    })
}
