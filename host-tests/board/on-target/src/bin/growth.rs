//! The estimator's step and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of 1, 2, 6 and 8 segments, 1000 samples each.
#![no_std]
#![no_main]

use on_target_tests::step::{TABLES, alone, steps};

#[cortex_m_rt::entry]
fn main() -> ! {
    let [one, two, six, eight] = &TABLES;
    alone(|| {
        steps::<1>(one);
        steps::<2>(two);
        steps::<6>(six);
        steps::<8>(eight);
    })
}
