//! Cause of the last reset, and software reset.
//!
//! ```no_run
//! use atsam3x8e_hal::{pac, reset};
//!
//! let device = pac::Peripherals::take().unwrap();
//! if reset::cause(&device.RSTC) == reset::Cause::PowerUp {
//!     reset::reset();
//! }
//! ```

use crate::{pac, reg};

/// Cause of a reset (RSTTYP, datasheet chapter 12, RSTC_SR).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// First power-up.
    PowerUp,
    /// Return from backup mode, or a brown-out that the supply controller detected.
    Backup,
    /// The watchdog was not fed.
    Watchdog,
    /// Software reset.
    Software,
    /// The NRST pin was pulled low: the reset button, or on the Due a host that opens the programming port.
    Pin,
    /// A code the datasheet does not list.
    Unknown,
}

/// Returns the cause of the last reset.
pub fn cause(rstc: &pac::RSTC) -> Cause {
    decode(rstc.sr.read().bits())
}

fn decode(status: u32) -> Cause {
    match status >> 8 & 0b111 {
        0 => Cause::PowerUp,
        1 => Cause::Backup,
        2 => Cause::Watchdog,
        3 => Cause::Software,
        4 => Cause::Pin,
        _ => Cause::Unknown,
    }
}

/// Resets processor and peripherals. Memory keeps its content.
///
/// Callable from anywhere, also from fault handlers.
pub fn reset() -> ! {
    /// Both bits together, with the key (datasheet chapter 12, RSTC_CR).
    const KEY_PERRST_PROCRST: u32 = 0xA5 << 24 | 1 << 2 | 1;
    // SAFETY: the reset controller is always there; writing its control register ends the program, so that its owner does not matter.
    let rstc = unsafe { &*pac::RSTC::ptr() };
    // The latest writes, for example a crash's record, reach memory before the reset.
    core::sync::atomic::fence(core::sync::atomic::Ordering::SeqCst);
    loop {
        reg::set(&rstc.cr, KEY_PERRST_PROCRST);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cause_is_read_from_rsttyp_whatever_the_other_bits() {
        let other_bits = 0x0003_0001;
        assert_eq!(decode(other_bits), Cause::PowerUp);
        assert_eq!(decode(other_bits | 2 << 8), Cause::Watchdog);
        assert_eq!(decode(other_bits | 3 << 8), Cause::Software);
        assert_eq!(decode(other_bits | 4 << 8), Cause::Pin);
        assert_eq!(decode(other_bits | 7 << 8), Cause::Unknown);
    }
}
