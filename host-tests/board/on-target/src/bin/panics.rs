//! Functions that can panic, and one that cannot. The test of the firmware's panics finds them in this program's ELF file.
#![no_std]
#![no_main]

use core::hint::black_box;

use on_target_tests as _;

#[inline(never)]
fn indexes(values: [u8; 3], index: usize) -> u8 {
    values[index]
}

#[inline(never)]
fn divides(value: u32, divisor: u32) -> u32 {
    value / divisor
}

#[inline]
fn unwraps_inlined(value: Option<u32>) -> u32 {
    value.unwrap()
}

#[inline(never)]
fn adds(value: u32) -> u32 {
    value.wrapping_add(1)
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let index = indexes(black_box([1, 2, 3]), black_box(2));
    let quotient = divides(black_box(6), black_box(3));
    let value = unwraps_inlined(black_box(Some(1)));
    loop {
        black_box((index, quotient, value, adds(black_box(0))));
    }
}
