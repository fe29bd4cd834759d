//! Hardware abstraction layer for the ATSAM3X8E, the chip of the Arduino Due.
//!
//! One module per peripheral, over the register definitions of [`atsam3x`] (re-exported as [`pac`]). A driver consumes its
//! peripheral and its pins, so that the compiler refuses a second user; pins carry their mode in their type. Where
//! embedded-hal 1.0 has a trait, the driver implements it, the asynchronous one if the driver waits.
//!
//! "Datasheet" in this crate is Atmel-11057C, SAM3X / SAM3A Series, 23 March 2015; registers are cited by chapter and name.
//!
//! | module | peripheral |
//! |---|---|
//! | [`clock`] | PMC and flash wait states: 84 MHz from the 12 MHz crystal |
//! | [`gpio`] | PIO A to D: pins |
//! | [`tc`] | TC0: periodic trigger, 64-bit time |
//! | [`adc`] | ADC: triggered scans by PDC |
//! | [`twi`] | TWI0, TWI1: I2C master |
//! | [`pwm`] | PWM: channels updated together |
//! | [`uart`] | UART with PDC |
//! | [`watchdog`] | WDT |
//! | [`reset`] | RSTC: cause of the last reset, software reset |
//! | [`backup`] | GPBR: words that are retained over a reset |
//! | [`crash`] | message of a crash that is retained over the reset, HardFault handler |
//! | [`eefc`] | EEFC: flash as storage, unique identifier |
//! | [`cycles`] | DWT: cycle counter |
//!
//! # Features
//!
//! - `rt`: interrupt vectors of the PAC, and a HardFault handler (see [`crash`]).
//! - `rtic`: [`tc::Mono`] as an `rtic_time` monotonic.
//!
//! A `critical_section` implementation comes from the application, for example cortex-m's feature
//! `critical-section-single-core`.
#![no_std]

pub use atsam3x::atsam3x8e as pac;

pub mod adc;
pub mod backup;
pub mod clock;
pub mod crash;
pub mod cycles;
pub mod eefc;
pub mod gpio;
pub mod pwm;
pub mod reset;
pub mod tc;
pub mod twi;
pub mod uart;
pub mod watchdog;

mod pdc;
mod reg;
