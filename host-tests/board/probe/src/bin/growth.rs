//! The estimator's step and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of 1, 2, 6, 12 and 16 segments, 1000 samples each.
#![no_std]
#![no_main]

use atsam3x8e_hal::pac::Peripherals;
use board_probe::step::{TABLES, steps};

#[cortex_m_rt::entry]
fn main() -> ! {
    if let Some(device) = Peripherals::take() {
        atsam3x8e_hal::watchdog::disable(device.WDT);
    }
    let [one, two, six, twelve, sixteen] = &TABLES;
    steps::<1>(one);
    steps::<2>(two);
    steps::<6>(six);
    steps::<12>(twelve);
    steps::<16>(sixteen);
    loop {
        cortex_m::asm::wfi();
    }
}
