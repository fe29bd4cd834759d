//! Timer counter block 0: a periodic trigger on channel 0 and 64-bit time on channel 1.
//!
//! ```no_run
//! use atsam3x8e_hal::{clock, pac, tc};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).unwrap();
//! let channels = tc::split(device.TC0, clocks);
//! tc::Mono::start(channels.channel1);
//! // TIOA0 rises 100 times a second, and interrupt TC0 comes 100 µs after each edge.
//! let mut trigger = tc::Trigger::start(channels.channel0, 100, 100)?;
//!
//! // In the task bound to interrupt TC0:
//! if trigger.on_interrupt() {
//!     let time_us = tc::Mono::now_us();
//! #   let _ = time_us;
//! }
//!
//! // In the task bound to interrupt TC1:
//! tc::Mono::on_interrupt();
//! # Ok::<(), tc::Error>(())
//! ```

use crate::clock::Clocks;
use crate::{pac, reg};

mod half_periods;
#[cfg(feature = "rtic")]
mod monotonic;
#[cfg(feature = "rtic")]
mod rtic;

pub use half_periods::TICK_HZ;

use half_periods::{COVFS, CPAS, CPCS, block, now_ticks};

/// Imports of a program that uses [`Mono`] as a monotonic.
#[cfg(feature = "rtic")]
pub mod prelude {
    pub use super::Mono;
    pub use rtic_time::fugit::{self, ExtU64, ExtU64Ceil};
    pub use rtic_time::{Monotonic, Timebase};
}

/// TCCLKS: TIMER_CLOCK1.
const TIMER_CLOCK1: u32 = 0;
/// EEVT: external event is XC0, so that TIOB stays an output and RB may be used (datasheet chapter 36, TC_CMR).
const EEVT_XC0: u32 = 1 << 10;
const WAVSEL_UP_RC: u32 = 0b10 << 13;
const WAVE: u32 = 1 << 15;
const ACPA_CLEAR: u32 = 0b10 << 16;
const ACPC_SET: u32 = 0b01 << 18;
const ASWTRG_SET: u32 = 0b01 << 22;

/// CLKEN and SWTRG: the counter starts from 0 (datasheet chapter 36, TC_CCR).
const CCR_START: u32 = 1 << 0 | 1 << 2;

/// The two channels of block 0 that this crate uses.
#[derive(Debug)]
pub struct Channels {
    /// For [`Trigger`].
    pub channel0: Channel0,
    /// For [`Mono`].
    pub channel1: Channel1,
}

/// Channel 0 of block 0; its interrupt is TC0.
#[derive(Debug)]
pub struct Channel0(());

/// Channel 1 of block 0; its interrupt is TC1.
#[derive(Debug)]
pub struct Channel1(());

/// Takes block 0 apart and clocks its channels.
pub fn split(_tc0: pac::TC0, clocks: Clocks) -> Channels {
    clocks.enable(pac::Interrupt::TC0);
    clocks.enable(pac::Interrupt::TC1);
    Channels { channel0: Channel0(()), channel1: Channel1(()) }
}

/// Errors of the start of a trigger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// 42 MHz is not a multiple of the frequency, so that the period would not be exact.
    #[error("the trigger's frequency must divide 42 MHz")]
    Frequency,
    /// The interrupt would come with or after the next edge.
    #[error("the interrupt's delay must be longer than 0 and shorter than the period")]
    Delay,
}

/// A rising edge on TIOA0 at an exact period, and an interrupt at a fixed delay after it.
///
/// The edge starts other peripherals in hardware, without jitter; the interrupt comes when they are done.
#[derive(Debug)]
pub struct Trigger(Channel0);

impl Trigger {
    /// Starts at once: the first edge comes now, the first interrupt `interrupt_delay_us` later.
    ///
    /// Waveform mode, counting up to RC (datasheet chapter 36, WAVSEL = 10): TIOA is set at the start and by RC, cleared by RA, and RA
    /// compare is the interrupt.
    ///
    /// # Errors
    ///
    /// A frequency that is not exact, or a delay of 0 or beyond the period; nothing was started.
    pub fn start(channel: Channel0, frequency_hz: u32, interrupt_delay_us: u32) -> Result<Self, Error> {
        let (period, delay) = periods(frequency_hz, interrupt_delay_us)?;
        let tc = block();
        reg::set(
            tc.wave_eq_1_cmr0_wave_eq_1(),
            TIMER_CLOCK1 | EEVT_XC0 | WAVSEL_UP_RC | WAVE | ACPA_CLEAR | ACPC_SET | ASWTRG_SET,
        );
        reg::set(&tc.ra0, delay);
        reg::set(&tc.rc0, period);
        let _clear_pending = tc.sr0.read();
        reg::set(&tc.ier0, CPAS);
        reg::set(&tc.ccr0, CCR_START);
        Ok(Self(channel))
    }

    /// Clears the interrupt; called by the handler of interrupt TC0. False if it was not due.
    pub fn on_interrupt(&mut self) -> bool {
        block().sr0.read().bits() & CPAS != 0
    }
}

/// Period and delay of a trigger in ticks.
fn periods(frequency_hz: u32, interrupt_delay_us: u32) -> Result<(u32, u32), Error> {
    if frequency_hz == 0 || !TICK_HZ.is_multiple_of(frequency_hz) {
        return Err(Error::Frequency);
    }
    let period = TICK_HZ / frequency_hz;
    let delay = interrupt_delay_us.checked_mul(TICK_HZ / 1_000_000).ok_or(Error::Delay)?;
    if (1..period).contains(&delay) { Ok((period, delay)) } else { Err(Error::Delay) }
}

/// 64-bit time since [`Mono::start`], in ticks of 1/42 µs. It does not wrap within 13 900 years.
///
/// A 32-bit counter wraps every 102 s. Software counts its half periods: the RA compare interrupt comes at 2³¹, the
/// overflow interrupt at 0. One bit of that count overlaps the counter's top bit, which shows whether the interrupt of the
/// latest half period was already counted. So the time is right at any instant and at any priority, as long as interrupt
/// TC1 is served within 51 s.
#[derive(Debug, Clone, Copy)]
pub struct Mono;

impl Mono {
    /// Starts the time at 0.
    pub fn start(_channel: Channel1) {
        let tc = block();
        // WAVSEL 00: up to 2³² − 1, RC compare does not reset the counter (datasheet chapter 36).
        reg::set(tc.wave_eq_1_cmr1_wave_eq_1(), TIMER_CLOCK1 | EEVT_XC0 | WAVE);
        reg::set(&tc.ra1, 1 << 31);
        let _clear_pending = tc.sr1.read();
        reg::set(&tc.ier1, COVFS | CPAS | CPCS);
        reg::set(&tc.ccr1, CCR_START);
        #[cfg(feature = "rtic")]
        rtic::initialize();
    }

    /// Ticks of 1/42 µs since the start.
    pub fn now_ticks() -> u64 {
        now_ticks()
    }

    /// Microseconds since the start.
    pub fn now_us() -> u64 {
        Self::now_ticks() / u64::from(TICK_HZ / 1_000_000)
    }

    /// Counts the time and wakes tasks; called by the handler of interrupt TC1.
    pub fn on_interrupt() {
        #[cfg(feature = "rtic")]
        rtic::on_interrupt();
        #[cfg(not(feature = "rtic"))]
        half_periods::count_half_periods();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_hertz_is_420_000_ticks_exactly() {
        assert_eq!(periods(100, 100), Ok((420_000, 4_200)));
    }

    #[test]
    fn an_inexact_frequency_or_an_impossible_delay_is_refused() {
        assert_eq!(periods(0, 1), Err(Error::Frequency));
        assert_eq!(periods(99, 1), Err(Error::Frequency));
        assert_eq!(periods(100, 0), Err(Error::Delay));
        assert_eq!(periods(100, 10_000), Err(Error::Delay));
        assert_eq!(periods(100, u32::MAX), Err(Error::Delay));
    }
}
