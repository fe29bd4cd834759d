//! Shared parts of the on-target tests: the arithmetic that board and host compare, and the line for its results.
//!
//! | test | subject |
//! |---|---|
//! | `arithmetic` | the estimator's arithmetic and soft float, hashed over random inputs |
//! | `interrupted` | the same while a fast interrupt strikes everywhere |
//! | `panics` | functions that can panic, for the test that finds them; it is not run |
//! | `preemption` | the order in which tasks of three priorities run |
//! | `step` | the estimator's step and nothing else, for the benchmark |
//! | `bias_filter` | the same with bias filter, contact and uncertainty |
//! | `bias_filter_growth` | that for an arm of eight segments |
//! | `growth` | `step` for arms of 1 to 8 segments |
#![no_std]

pub mod arithmetic;
#[cfg(target_os = "none")]
pub mod line;
pub mod random;

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
#[cfg(target_os = "none")]
pub mod step;
