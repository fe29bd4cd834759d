//! ADC: a set of channels, scanned at each edge of a timer, without the processor.
//!
//! A timer's TIOA starts the conversion of all enabled channels in ascending order (datasheet 43.6.5); the PDC stores
//! the results, each with its channel's number in the top four bits (TAG, datasheet 43.6.11). [`Adc::take_scan`] returns
//! a scan only if every word has the number of its position.
//!
//! ```no_run
//! use atsam3x8e_hal::{adc, clock, pac};
//!
//! # fn buffer<const N: usize>() -> &'static mut [u16; N] { unimplemented!() }
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).unwrap();
//! // The Due's A0 to A7 are channels 7 to 0, A8 to A11 are channels 10 to 13.
//! let mut adc = adc::Adc::new(device.ADC, 0x3CFF, adc::Trigger::Tc0Channel0, buffer::<12>(), clocks)?;
//!
//! // A stated time after each edge:
//! match adc.take_scan() {
//!     Ok(counts) => { let a0 = counts[7]; let a8 = counts[8]; }
//!     Err(_error) => { /* this tick has no bend readings */ }
//! }
//! # Ok::<(), adc::Error>(())
//! ```
//!
//! # Timing
//!
//! At 14 MHz a channel takes some 20 to 26 clocks, so that 12 channels are done 23 µs after the edge. During the
//! 15 clocks (1.07 µs) of tracking, the sampling capacitor follows a source of at most 16 kΩ to 12 bits (datasheet 45.7.2.1:
//! t = 0.054 · Z + 205 ns): there is no input buffer. A source of more needs a capacitor at the pin.

use core::ptr::NonNull;
use core::sync::atomic::{Ordering, fence};

use crate::clock::Clocks;
use crate::{pac, reg};

const CR_SWRST: u32 = 1;
const MR_TRGEN: u32 = 1;
/// PRESCAL 2: 84 MHz / ((2 + 1) · 2) = 14 MHz; the limit is 20 MHz (datasheet chapter 43, ADC_MR, and 45.7.2).
const MR_PRESCAL: u32 = 2 << 8;
/// STARTUP 10: 640 clocks, 46 µs; from off, the ADC needs 40 µs (datasheet 45.7.2).
const MR_STARTUP: u32 = 10 << 16;
/// SETTLING 3: 17 clocks. Used only where gain or offset differ between channels (datasheet 43.6.10), which they do not.
const MR_SETTLING: u32 = 3 << 20;
/// TRACKTIM 0 and TRANSFER 1, as the datasheet requires for sources of up to 16 kΩ at 14 MHz (45.7.2.1).
const MR_TRACKTIM_TRANSFER: u32 = 1 << 28;
const EMR_TAG: u32 = 1 << 24;
const ISR_GOVRE: u32 = 1 << 25;
const PTCR_RXTEN: u32 = 1;
const PTCR_RXTDIS: u32 = 1 << 1;

/// Trigger of a scan (TRGSEL, datasheet chapter 43, ADC_MR).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trigger {
    /// Rising edge of TIOA of timer block 0, channel 0: [`crate::tc::Trigger`].
    Tc0Channel0,
    /// Rising edge of TIOA of timer block 0, channel 1.
    Tc0Channel1,
    /// Rising edge of TIOA of timer block 0, channel 2.
    Tc0Channel2,
}

/// Errors of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The set of channels and the buffer differ in size.
    #[error("the buffer must hold one word for each enabled channel")]
    ChannelCount,
    /// The scan is not complete: there was no trigger, or the ADC stopped. It was set up again.
    #[error("the scan has {received} of its words: is the trigger running, and was it given time?")]
    Stalled {
        /// Words that were stored.
        received: usize,
    },
    /// A word has the number of another channel. The ADC was set up again.
    #[error("word {position} of the scan is of channel {found}, not {expected}")]
    WrongTag {
        /// Position in the scan.
        position: usize,
        /// Channel number of that position.
        expected: u8,
        /// Channel number found.
        found: u8,
    },
    /// A result was lost: a scan was taken too late. The ADC was set up again.
    #[error("results were lost: take each scan before the next trigger")]
    Overrun,
}

/// Scans `N` channels at each trigger.
#[derive(Debug)]
pub struct Adc<const N: usize> {
    registers: pac::ADC,
    channels: u16,
    trigger: Trigger,
    buffer: NonNull<[u16; N]>,
}

// SAFETY: the buffer came as a `&'static mut`, of which this is the only owner, and which is `Send`.
unsafe impl<const N: usize> Send for Adc<N> {}

impl<const N: usize> Adc<N> {
    /// Sets the ADC up to scan the channels whose bits are set, and waits for the first trigger.
    ///
    /// # Errors
    ///
    /// [`Error::ChannelCount`].
    pub fn new(
        adc: pac::ADC,
        channels: u16,
        trigger: Trigger,
        buffer: &'static mut [u16; N],
        clocks: Clocks,
    ) -> Result<Self, Error> {
        if channels.count_ones() as usize != N {
            return Err(Error::ChannelCount);
        }
        clocks.enable(pac::Interrupt::ADC);
        let mut this = Self { registers: adc, channels, trigger, buffer: NonNull::from(buffer) };
        this.set_up();
        Ok(this)
    }

    /// The last scan, in ascending order of channel numbers, as counts of 0 to 4095; then makes ready for the next
    /// trigger.
    ///
    /// To be called once for each trigger, after the scan's time (see the module) and before the next trigger.
    ///
    /// # Errors
    ///
    /// Any but [`Error::ChannelCount`]. The ADC was then reset, so that the next scan begins with its first channel, if it
    /// is not triggered within the 50 µs of its start-up.
    pub fn take_scan(&mut self) -> Result<[u16; N], Error> {
        // GOVRE is cleared by this read (datasheet chapter 43, ADC_ISR).
        let overrun = self.registers.isr.read().bits() & ISR_GOVRE != 0;
        let missing = self.registers.rcr.read().bits() as usize;
        let scan = if overrun {
            Err(Error::Overrun)
        } else if missing > 0 {
            Err(Error::Stalled { received: N.saturating_sub(missing) })
        } else {
            untag(self.words(), self.channels)
        };
        match scan {
            Ok(_) => self.grant(),
            Err(_) => self.set_up(),
        }
        scan
    }

    /// Resets the ADC, in any state, and sets it up.
    fn set_up(&mut self) {
        let adc = &self.registers;
        reg::set(&adc.ptcr, PTCR_RXTDIS);
        reg::set(&adc.cr, CR_SWRST);
        let trigger = match self.trigger {
            Trigger::Tc0Channel0 => 1,
            Trigger::Tc0Channel1 => 2,
            Trigger::Tc0Channel2 => 3,
        };
        let mode = MR_PRESCAL | MR_STARTUP | MR_SETTLING | MR_TRACKTIM_TRANSFER;
        reg::set(&adc.emr, EMR_TAG);
        reg::set(&adc.cher, u32::from(self.channels));
        // Results of a conversion before the reset.
        let _stale = (adc.lcdr.read(), adc.isr.read());
        self.grant();
        reg::set(&self.registers.mr, mode | trigger << 1 | MR_TRGEN);
    }

    /// Gives the buffer to the PDC for one scan.
    fn grant(&mut self) {
        let adc = &self.registers;
        fence(Ordering::SeqCst);
        // SAFETY: the PDC may write the N words of the buffer, which is never freed, and which the program reads only in
        // `words`, after the counter has reached 0.
        unsafe { adc.rpr.write_with_zero(|w| w.bits(self.buffer.as_ptr() as u32)) };
        // SAFETY: as above; one scan and no next buffer, so that a trigger too many overruns instead of overwriting.
        unsafe { adc.rncr.write_with_zero(|w| w.bits(0)) };
        // SAFETY: as above.
        unsafe { adc.rcr.write_with_zero(|w| w.bits(N as u32)) };
        reg::set(&adc.ptcr, PTCR_RXTEN);
    }

    /// The words of a complete scan.
    fn words(&self) -> [u16; N] {
        fence(Ordering::SeqCst);
        // SAFETY: the buffer is static, and the PDC does not write to it, since its counter is 0.
        unsafe { self.buffer.as_ptr().read_volatile() }
    }
}

/// Checks the channel number of each word and removes it.
fn untag<const N: usize>(words: [u16; N], channels: u16) -> Result<[u16; N], Error> {
    let mut counts = [0; N];
    let expected_channels = (0..16).filter(|channel| channels >> channel & 1 == 1);
    for (position, ((count, word), expected)) in counts.iter_mut().zip(words).zip(expected_channels).enumerate() {
        let found = (word >> 12) as u8;
        if found != expected {
            return Err(Error::WrongTag { position, expected, found });
        }
        *count = word & 0xFFF;
    }
    Ok(counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANNELS: u16 = 1 << 2 | 1 << 3 | 1 << 11;

    #[test]
    fn a_scan_in_channel_order_loses_its_tags() {
        assert_eq!(untag([0x2001, 0x3FFF, 0xB800], CHANNELS), Ok([0x001, 0xFFF, 0x800]));
    }

    #[test]
    fn a_word_of_another_channel_is_refused_with_its_place() {
        assert_eq!(
            untag([0x2001, 0xB800, 0x3FFF], CHANNELS),
            Err(Error::WrongTag { position: 1, expected: 3, found: 11 })
        );
        assert_eq!(untag([0x0000; 3], CHANNELS), Err(Error::WrongTag { position: 0, expected: 2, found: 0 }));
    }
}
