//! The estimator's step and nothing else: no line, no clock, and neither floats nor panics anywhere.
//!
//! For arms of six segments, as the firmware has it, 1000 samples each.
#![no_std]
#![no_main]

use atsam3x8e_hal::pac::Peripherals;
use board_probe::step::{TABLES, steps};

#[cortex_m_rt::entry]
fn main() -> ! {
    if let Some(device) = Peripherals::take() {
        atsam3x8e_hal::watchdog::disable(device.WDT);
    }
    let [_, _, six, _, _] = &TABLES;
    steps::<6>(six);
    loop {
        cortex_m::asm::wfi();
    }
}
