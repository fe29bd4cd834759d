//! The estimator's step beyond the paper and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For an arm of six segments with observer, contact and uncertainty, 1000 samples.
#![no_std]
#![no_main]

use atsam3x8e_hal::pac::Peripherals;
use board_probe::step::{TABLE_BEYOND, steps_with_uncertainty};

#[cortex_m_rt::entry]
fn main() -> ! {
    if let Some(device) = Peripherals::take() {
        atsam3x8e_hal::watchdog::disable(device.WDT);
    }
    steps_with_uncertainty::<6>(&TABLE_BEYOND);
    loop {
        cortex_m::asm::wfi();
    }
}
