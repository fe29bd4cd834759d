//! Clock tree: 84 MHz master clock from the Due's 12 MHz crystal.
//!
//! ```no_run
//! use atsam3x8e_hal::{clock, pac};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1)?;
//! assert_eq!(clocks.mck(), 84_000_000);
//! # Ok::<(), clock::Error>(())
//! ```

use crate::{pac, reg};

/// Master clock in Hz: 12 MHz · 14 / 2, the chip's maximum (datasheet chapter 45).
pub const MCK_HZ: u32 = 84_000_000;

/// Polls of a status bit before a step counts as failed. The longest wait of a healthy chip is 64 slow clocks, 2 ms, or
/// 8 000 cycles of the 4 MHz oscillator; a poll takes several.
const POLLS: u32 = 100_000;

/// MOR writes need this key (datasheet chapter 28, CKGR_MOR).
const MOR_KEY: u32 = 0x37 << 16;
const MOR_MOSCXTEN: u32 = 1 << 0;
const MOR_MOSCRCEN: u32 = 1 << 3;
/// Crystal start-up: 8 · 8 slow clocks (2 ms); the crystal needs up to 1.4 ms at 12 MHz (datasheet chapter 45, crystal oscillator).
const MOR_MOSCXTST: u32 = 8 << 8;
const MOR_MOSCSEL: u32 = 1 << 24;

/// PLLA: 12 MHz / 1 · (13 + 1) = 168 MHz, lock counted for 0x3F slow clocks; bit 29 is always 1 (datasheet chapter 28, CKGR_PLLAR).
const PLLA_14: u32 = 1 << 29 | 13 << 16 | 0x3F << 8 | 1;

/// Status (datasheet chapter 28, PMC_SR).
const SR_MOSCXTS: u32 = 1 << 0;
const SR_LOCKA: u32 = 1 << 1;
const SR_MCKRDY: u32 = 1 << 3;
const SR_MOSCSELS: u32 = 1 << 16;

const MCKR_CSS_MAIN: u32 = 1;
const MCKR_CSS_PLLA: u32 = 2;
/// Divides the selected clock by 2 (datasheet chapter 28, PMC_MCKR).
const MCKR_PRES_2: u32 = 1 << 4;

/// Flash wait states at 84 MHz: FWS 4 (datasheet chapter 45, embedded flash).
const FLASH_WAIT_STATES: u32 = 4 << 8;

/// Step of the clock set-up that did not finish. The chip then still runs, on the clock of the previous step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The crystal did not start.
    #[error("the 12 MHz crystal did not start: check it and its capacitors")]
    Crystal,
    /// The main clock did not switch to the crystal.
    #[error("the main clock did not switch to the crystal")]
    MainClock,
    /// The master clock did not switch to the main clock.
    #[error("the master clock did not switch to the main clock")]
    MasterFromMain,
    /// The PLL did not lock.
    #[error("PLLA did not lock at 168 MHz")]
    PllA,
    /// The prescaler did not take its value.
    #[error("the master clock's prescaler was not accepted")]
    Prescaler,
    /// The master clock did not switch to the PLL.
    #[error("the master clock did not switch to PLLA")]
    MasterFromPllA,
}

/// Proof that the chip runs at [`MCK_HZ`]; switches the clocks of peripherals.
#[derive(Debug, Clone, Copy)]
pub struct Clocks(());

/// Brings the chip to 84 MHz. Takes about 5 ms.
///
/// The flash wait states come first, since the flash must never run too fast (datasheet chapter 18, EEFC_FMR); PRES and CSS are
/// written one at a time with a wait between, as the datasheet requires (chapter 28, PMC_MCKR).
///
/// # Errors
///
/// The step that did not finish; every wait is bounded.
pub fn configure(pmc: pac::PMC, efc0: &pac::EFC0, efc1: &pac::EFC1) -> Result<Clocks, Error> {
    reg::set(&efc0.fmr, FLASH_WAIT_STATES);
    reg::set(&efc1.fmr, FLASH_WAIT_STATES);

    let await_status = |mask: u32, error: Error| {
        reg::wait(POLLS, || pmc.pmc_sr.read().bits() & mask == mask).then_some(()).ok_or(error)
    };

    // The RC oscillator stays on: it is what the chip falls back to, and runs until MOSCSEL has switched.
    let oscillators = MOR_KEY | MOR_MOSCXTST | MOR_MOSCRCEN | MOR_MOSCXTEN;
    reg::set(&pmc.ckgr_mor, oscillators | pmc.ckgr_mor.read().bits() & MOR_MOSCSEL);
    await_status(SR_MOSCXTS, Error::Crystal)?;
    reg::set(&pmc.ckgr_mor, oscillators | MOR_MOSCSEL);
    await_status(SR_MOSCSELS, Error::MainClock)?;

    // Off the PLL before it is programmed, in case a boot loader left it selected.
    reg::set(&pmc.pmc_mckr, pmc.pmc_mckr.read().bits() & !0b11 | MCKR_CSS_MAIN);
    await_status(SR_MCKRDY, Error::MasterFromMain)?;
    reg::set(&pmc.ckgr_pllar, PLLA_14);
    await_status(SR_LOCKA, Error::PllA)?;
    reg::set(&pmc.pmc_mckr, MCKR_PRES_2 | MCKR_CSS_MAIN);
    await_status(SR_MCKRDY, Error::Prescaler)?;
    reg::set(&pmc.pmc_mckr, MCKR_PRES_2 | MCKR_CSS_PLLA);
    await_status(SR_MCKRDY, Error::MasterFromPllA)?;
    Ok(Clocks(()))
}

impl Clocks {
    /// Master clock in Hz.
    pub const fn mck(self) -> u32 {
        MCK_HZ
    }

    /// Switches a peripheral's clock on. The drivers of this crate do it themselves.
    ///
    /// A peripheral has the same number in the NVIC and in the PMC (datasheet chapter 9, peripheral identifiers).
    pub fn enable(self, peripheral: pac::Interrupt) {
        match bit(peripheral) {
            (0, mask) => reg::set(&pmc().pmc_pcer0, mask),
            (_, mask) => reg::set(&pmc().pmc_pcer1, mask),
        }
    }

    /// Switches a peripheral's clock off.
    pub fn disable(self, peripheral: pac::Interrupt) {
        match bit(peripheral) {
            (0, mask) => reg::set(&pmc().pmc_pcdr0, mask),
            (_, mask) => reg::set(&pmc().pmc_pcdr1, mask),
        }
    }
}

/// Register (PCER0 or PCER1) and bit of a peripheral (datasheet chapter 28, PMC_PCER0 and 1).
fn bit(peripheral: pac::Interrupt) -> (u16, u32) {
    let number = peripheral as u16;
    (number / 32, 1 << (number % 32))
}

fn pmc() -> &'static pac::pmc::RegisterBlock {
    // SAFETY: the PMC is always there. `Clocks` exists only after `configure` consumed the `PMC`, and afterwards only
    // set and clear registers are written, which need no read-modify-write.
    unsafe { &*pac::PMC::ptr() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peripheral_s_clock_bit_is_its_number_split_at_32() {
        assert_eq!(bit(pac::Interrupt::UART), (0, 1 << 8));
        assert_eq!(bit(pac::Interrupt::TC4), (0, 1 << 31));
        assert_eq!(bit(pac::Interrupt::TC5), (1, 1 << 0));
        assert_eq!(bit(pac::Interrupt::ADC), (1, 1 << 5));
    }
}
