//! The estimator's step beyond the paper and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For an arm of six segments with observer, contact and uncertainty, 1000 samples.
#![no_std]
#![no_main]

use board_probe::step::{TABLE_BEYOND, alone, steps_with_uncertainty};

#[cortex_m_rt::entry]
fn main() -> ! {
    alone(|| steps_with_uncertainty::<6>(&TABLE_BEYOND))
}
