//! The estimator's arithmetic on a million random inputs.
#![no_std]
#![no_main]

use core::fmt::Write;

use atsam3x8e_hal::pac::Peripherals;
use on_target_tests::arithmetic::hashes;
use on_target_tests::line::Line;

const INPUTS: u32 = 1_000_000;

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut line = Line::open(Peripherals::take().expect("it is the first"));
    for (name, hash) in hashes(INPUTS) {
        let _ = writeln!(line, "{name} {hash:08x}");
    }
    line.close()
}
