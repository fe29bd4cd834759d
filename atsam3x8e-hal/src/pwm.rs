//! PWM: up to eight channels with one period, updated together.
//!
//! ```no_run
//! use atsam3x8e_hal::pwm::{self, Output, Period, Polarity, Prescaler, Pwm};
//! use atsam3x8e_hal::{clock, gpio::Split, pac};
//!
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).unwrap();
//! let port_c = device.PIOC.split(clocks);
//! // The Due's D6 and D7. 84 MHz / 2 / 42000 counts = 1 kHz.
//! let outputs = [Output::from(port_c.pc24), Output::from(port_c.pc23)];
//! let period = Period { prescaler: Prescaler::Div2, counts: 42_000 };
//! let mut valves = Pwm::new(device.PWM, outputs, period, Polarity::ActiveHigh, clocks)?;
//! valves.set_duties([21_000, 0])?;
//!
//! // In a panic or fault handler, without the driver:
//! pwm::disable_all_outputs();
//! # Ok::<(), pwm::Error>(())
//! ```

use core::sync::atomic::{AtomicU32, Ordering};

use embedded_hal::digital::PinState;

use crate::clock::Clocks;
use crate::gpio::{self, Pin};
use crate::{pac, reg};

/// CPOL (datasheet chapter 38, PWM_CMR).
const CMR_CPOL: u32 = 1 << 9;
/// UPDULOCK (datasheet chapter 38, PWM_SCUC).
const SCUC_UPDULOCK: u32 = 1;

/// Pins of port C that a [`Pwm`] was given, by their inactive level.
static LOW_AT_REST: AtomicU32 = AtomicU32::new(0);
static HIGH_AT_REST: AtomicU32 = AtomicU32::new(0);

/// A channel and the pin of its output PWML. All eight are on port C, peripheral B.
#[derive(Debug)]
pub struct Output {
    channel: u8,
    pin: u8,
}

macro_rules! outputs {
    ($($channel:literal $pin:literal),+) => { $(
        impl<MODE> From<Pin<'C', $pin, MODE>> for Output {
            #[doc = concat!("PWML", $channel, " on PC", $pin, ".")]
            fn from(_: Pin<'C', $pin, MODE>) -> Self {
                Self { channel: $channel, pin: $pin }
            }
        }
    )+ };
}

// PWML0 to PWML7 (datasheet chapter 9, multiplexing on PIO controller C).
outputs!(0 2, 1 4, 2 6, 3 8, 4 21, 5 22, 6 23, 7 24);

/// Division of the master clock for the common counter (CPRE, datasheet chapter 38, PWM_CMR).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prescaler {
    /// 84 MHz.
    Div1 = 0,
    /// 42 MHz.
    Div2 = 1,
    /// 21 MHz.
    Div4 = 2,
    /// 10.5 MHz.
    Div8 = 3,
    /// 5.25 MHz.
    Div16 = 4,
    /// 2.625 MHz.
    Div32 = 5,
    /// 1.3125 MHz.
    Div64 = 6,
    /// 656.25 kHz.
    Div128 = 7,
    /// 328.125 kHz.
    Div256 = 8,
    /// 164.0625 kHz.
    Div512 = 9,
    /// 82.03125 kHz.
    Div1024 = 10,
}

/// The common period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Period {
    /// The counter's clock.
    pub prescaler: Prescaler,
    /// Counts a period; duties are in the same counts.
    pub counts: u16,
}

/// Level of an output during its duty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polarity {
    /// High during the duty, low otherwise.
    ActiveHigh,
    /// Low during the duty, high otherwise.
    ActiveLow,
}

/// Errors; the call had no effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The period has no counts.
    #[error("a PWM period has at least one count")]
    Period,
    /// A duty is longer than the period.
    #[error("duty {duty} of output {output} is longer than the period")]
    DutyOverPeriod {
        /// Index in the array of outputs.
        output: usize,
        /// The duty, counts.
        duty: u16,
    },
    /// The previous duties have not yet taken effect.
    #[error("the last duties wait for the end of their period: set duties at most once a period")]
    UpdatePending,
}

/// `N` outputs that change in the same period.
#[derive(Debug)]
pub struct Pwm<const N: usize> {
    registers: pac::PWM,
    outputs: [Output; N],
    period: u16,
}

impl<const N: usize> Pwm<N> {
    /// Starts the outputs at duty 0. The pins are at their inactive level throughout: they are driven as GPIO until their
    /// channels run.
    ///
    /// # Errors
    ///
    /// [`Error::Period`].
    pub fn new(
        pwm: pac::PWM,
        outputs: [Output; N],
        period: Period,
        polarity: Polarity,
        clocks: Clocks,
    ) -> Result<Self, Error> {
        if period.counts == 0 {
            return Err(Error::Period);
        }
        let pins = outputs.iter().fold(0, |pins, output| pins | 1 << output.pin);
        let (inactive, at_rest, cpol) = match polarity {
            Polarity::ActiveHigh => (PinState::Low, &LOW_AT_REST, 0),
            Polarity::ActiveLow => (PinState::High, &HIGH_AT_REST, CMR_CPOL),
        };
        gpio::drive(gpio::port('C'), pins, inactive);
        at_rest.fetch_or(pins, Ordering::Relaxed);

        clocks.enable(pac::Interrupt::PWM);
        // Synchronous channels are defined while they are off; channel 0 gives them its counter, whether or not it has an
        // output itself (datasheet 38.6.2.7). UPDM 0: an update takes effect at the end of the period in which UPDULOCK
        // is set, for all channels at once.
        let channels = outputs.iter().fold(1, |channels, output| channels | 1 << output.channel);
        reg::set(&pwm.dis, 0xFF);
        reg::set(&pwm.scm, channels);
        for number in (0..8).filter(|number| channels >> number & 1 == 1) {
            let channel = Channel::new(&pwm, number);
            channel.set_mode(cpol | period.prescaler as u32);
            channel.set_period(u32::from(period.counts));
            // PWML is the complement of the waveform, which is low (CPOL 0) for CDTY counts: the pin is high for CDTY
            // counts of CPRD (datasheet 38.6.2.2, 38.6.2.4).
            channel.set_duty(0);
        }
        reg::set(&pwm.ena, channels);
        gpio::select_peripheral(gpio::port('C'), pins, true);
        Ok(Self { registers: pwm, outputs, period: period.counts })
    }

    /// Counts a period, the largest duty.
    pub fn period(&self) -> u16 {
        self.period
    }

    /// Sets all duties, in counts of the period, in the order of the outputs. They take effect together, at the end of the
    /// running period.
    ///
    /// # Errors
    ///
    /// A duty beyond the period, or a call before the last duties took effect; no duty changes then.
    pub fn set_duties(&mut self, duties: [u16; N]) -> Result<(), Error> {
        if let Some((output, &duty)) = duties.iter().enumerate().find(|&(_, &duty)| duty > self.period) {
            return Err(Error::DutyOverPeriod { output, duty });
        }
        // With the update unlocked, a period that ends between two of the writes below would take half of them.
        if self.registers.scuc.read().bits() & SCUC_UPDULOCK != 0 {
            return Err(Error::UpdatePending);
        }
        for (output, duty) in self.outputs.iter().zip(duties) {
            Channel::new(&self.registers, output.channel).set_next_duty(u32::from(duty));
        }
        reg::set(&self.registers.scuc, SCUC_UPDULOCK);
        Ok(())
    }
}

/// Drives every pin that a [`Pwm`] was given to its inactive level, as GPIO, and stops the PWM. Callable from anywhere, also
/// from fault handlers; the outputs stay inactive until the next reset.
pub fn disable_all_outputs() {
    gpio::drive(gpio::port('C'), LOW_AT_REST.load(Ordering::Relaxed), PinState::Low);
    gpio::drive(gpio::port('C'), HIGH_AT_REST.load(Ordering::Relaxed), PinState::High);
    // SAFETY: the PWM is always there, and its disable register needs no owner: this overrides it on purpose.
    reg::set(unsafe { &(*pac::PWM::ptr()).dis }, 0xFF);
}

/// One channel's registers.
struct Channel<'a> {
    pwm: &'a pac::pwm::RegisterBlock,
    number: u8,
}

macro_rules! channel_register {
    ($(#[$doc:meta])* $name:ident: $r0:ident $r1:ident $r2:ident $r3:ident $r4:ident $r5:ident $r6:ident $r7:ident) => {
        $(#[$doc])*
        fn $name(&self, value: u32) {
            match self.number {
                0 => reg::set(&self.pwm.$r0, value),
                1 => reg::set(&self.pwm.$r1, value),
                2 => reg::set(&self.pwm.$r2, value),
                3 => reg::set(&self.pwm.$r3, value),
                4 => reg::set(&self.pwm.$r4, value),
                5 => reg::set(&self.pwm.$r5, value),
                6 => reg::set(&self.pwm.$r6, value),
                _ => reg::set(&self.pwm.$r7, value),
            }
        }
    };
}

impl<'a> Channel<'a> {
    fn new(pwm: &'a pac::PWM, number: u8) -> Self {
        Self { pwm, number }
    }

    channel_register!(set_mode: cmr0 cmr1 cmr2 cmr3 cmr4 cmr5 cmr6 cmr7);
    channel_register!(set_period: cprd0 cprd1 cprd2 cprd3 cprd4 cprd5 cprd6 cprd7);
    channel_register!(set_duty: cdty0 cdty1 cdty2 cdty3 cdty4 cdty5 cdty6 cdty7);
    channel_register!(
        /// Taken over at the next update.
        set_next_duty: cdtyupd0 cdtyupd1 cdtyupd2 cdtyupd3 cdtyupd4 cdtyupd5 cdtyupd6 cdtyupd7
    );
}
