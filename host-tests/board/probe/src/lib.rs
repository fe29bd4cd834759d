//! What the probes share: the arithmetic that board and host compare, and the line to tell of it.
//!
//! | probe | what it shows |
//! |---|---|
//! | `arithmetic` | the estimator's arithmetic and soft float, hashed over random inputs |
//! | `interrupted` | the same while a fast interrupt strikes everywhere |
//! | `preemption` | in which order tasks of three priorities run |
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
