//! Cycle counter of the processor, for measurements of execution time.
//!
//! ```no_run
//! use atsam3x8e_hal::cycles;
//!
//! let mut core = cortex_m::Peripherals::take().unwrap();
//! cycles::enable(&mut core.DCB, &mut core.DWT);
//! let start = cycles::now();
//! // ... work ...
//! let spent = cycles::now().wrapping_sub(start);
//! # let _ = spent;
//! ```

use cortex_m::peripheral::{DCB, DWT};

/// Starts the counter: trace enabled in DEMCR, then CYCCNTENA (ARMv7-M C1.6.5, C1.8.7).
pub fn enable(dcb: &mut DCB, dwt: &mut DWT) {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
}

/// Cycles of the processor's clock, modulo 2³² (51 s at 84 MHz); subtract with `wrapping_sub`.
pub fn now() -> u32 {
    DWT::cycle_count()
}
