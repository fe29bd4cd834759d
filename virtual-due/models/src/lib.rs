//! Models of the SAM3X8E's peripherals, from the datasheet (SAM3X/A, Atmel 11057C).
//!
//! A model is a [`model::Peripheral`]: registers that are read and written, the instant of its next event, interrupt lines.
//! It is called with a [`model::Context`]: the time, the master clock, the chip's memory and the [`model::World`] on its
//! pins. The models depend on no CPU engine and no board; `virtual-due` connects them to both. They share no code with the
//! drivers of `atsam3x8e-hal`, so that the two do not share mistakes.
//!
//! | section | peripherals |
//! |---|---|
//! | system controller | [`Rstc`], [`Supc`], [`Wdt`], [`Rtt`], [`Rtc`], [`Gpbr`], [`Pmc`], [`Matrix`], [`Eefc`], [`ChipId`], [`Trng`] |
//! | pins and time | [`Pio`], [`Tc`], [`Pwm`], [`Adc`], [`Dacc`] |
//! | serial | [`Uart`], [`Usart`], [`Twi`], [`Spi`], [`Uotghs`] |
//! | memory | [`Dmac`] |
//! | others | [`Unmodelled`] |

#![expect(
    clippy::new_without_default,
    reason = "`new` is the state after power-on, which no caller takes as a default"
)]

mod adc;
mod chipid;
mod dacc;
mod dmac;
mod eefc;
pub mod flash;
mod gpbr;
mod matrix;
pub mod model;
mod pdc;
mod pio;
mod pmc;
mod pwm;
mod rstc;
mod rtc;
mod rtt;
mod serial;
mod spi;
mod supc;
mod tc;
#[cfg(test)]
mod test_support;
mod ticks;
mod trng;
mod twi;
mod uart;
mod unmodelled;
mod uotghs;
mod usart;
mod warning_log;
mod wdt;
mod write_protection;

pub use adc::Adc;
pub use chipid::ChipId;
pub use dacc::Dacc;
pub use dmac::Dmac;
pub use eefc::Eefc;
pub use gpbr::Gpbr;
pub use matrix::Matrix;
pub use pio::Pio;
pub use pmc::Pmc;
pub use pwm::Pwm;
pub use rstc::Rstc;
pub use rtc::Rtc;
pub use rtt::Rtt;
pub use spi::Spi;
pub use supc::Supc;
pub use tc::Tc;
pub use trng::Trng;
pub use twi::Twi;
pub use uart::Uart;
pub use unmodelled::Unmodelled;
pub use uotghs::Uotghs;
pub use usart::Usart;
pub use warning_log::{Warning, WarningLog};
pub use wdt::Wdt;
