//! Watchdog: resets processor and peripherals unless it is fed.
//!
//! The chip starts with its watchdog running, at about 16 s, and its mode can be written once after a reset: [`Watchdog::start`]
//! and [`disable`] consume the peripheral.
//!
//! ```no_run
//! use atsam3x8e_hal::{pac, watchdog::Watchdog};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let mut watchdog = Watchdog::start(device.WDT, 250)?;
//! loop {
//!     watchdog.feed();
//! }
//! # #[allow(unreachable_code)]
//! # Ok::<(), atsam3x8e_hal::watchdog::Error>(())
//! ```

use crate::{pac, reg};

const KEY: u32 = 0xA5 << 24;
const WDRSTT: u32 = 1;
const WDRSTEN: u32 = 1 << 13;
const WDDIS: u32 = 1 << 15;
/// A window as wide as the counter: feeding is allowed at any time (datasheet chapter 15, WDT_MR).
const WDD_NO_WINDOW: u32 = 0xFFF << 16;
const WDDBGHLT: u32 = 1 << 28;

/// Errors of the start of the watchdog.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The period does not fit the 12-bit counter of 3.9 ms steps.
    #[error("a watchdog period is 4 to 15996 ms")]
    Period,
}

/// A running watchdog.
#[derive(Debug)]
pub struct Watchdog(pac::WDT);

impl Watchdog {
    /// Starts the watchdog with a nominal period in ms, 4 to 15996. It counts while the processor sleeps and stops while
    /// a debugger halts it.
    ///
    /// The period is counted in slow clocks (32 768 Hz / 128, datasheet chapter 15, WDT_MR). Without the 32 kHz crystal, as on the Due,
    /// that is an RC oscillator of 20 to 44 kHz (datasheet chapter 45, slow clock RC oscillator): the true period is 0.74 to 1.64 times the nominal one.
    ///
    /// # Errors
    ///
    /// [`Error::Period`]; the chip's own 16 s watchdog then runs on.
    pub fn start(wdt: pac::WDT, period_ms: u32) -> Result<Self, Error> {
        let count = count(period_ms).ok_or(Error::Period)?;
        // WDRPROC 0: the reset takes the peripherals too, not only the processor (datasheet chapter 15, WDT_MR).
        reg::set(&wdt.mr, count | WDRSTEN | WDD_NO_WINDOW | WDDBGHLT);
        Ok(Self(wdt))
    }

    /// Restarts the period.
    pub fn feed(&mut self) {
        reg::set(&self.0.cr, KEY | WDRSTT);
    }
}

/// Stops the watchdog until the next reset.
pub fn disable(wdt: pac::WDT) {
    reg::set(&wdt.mr, WDDIS);
}

/// WDV for a period: steps of 1/256 s, rounded up so that no period is shorter than the argument.
fn count(period_ms: u32) -> Option<u32> {
    let count = period_ms.checked_mul(256)?.div_ceil(1000);
    (period_ms >= 4 && count <= 0xFFF).then_some(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_is_counted_in_steps_of_a_256th_of_a_second() {
        assert_eq!(count(250), Some(64));
        assert_eq!(count(1000), Some(256));
        assert_eq!(count(4), Some(2));
    }

    #[test]
    fn a_period_that_does_not_fit_is_refused() {
        assert_eq!(count(15_996), Some(0xFFF));
        assert_eq!(count(15_997), None);
        assert_eq!(count(3), None);
        assert_eq!(count(u32::MAX), None);
    }
}
