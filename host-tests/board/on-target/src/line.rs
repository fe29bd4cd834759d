//! The serial line, for the results of a test as text.

use core::convert::Infallible;
use core::fmt;

use atsam3x8e_hal::gpio::Split;
use atsam3x8e_hal::pac::Peripherals;
use atsam3x8e_hal::uart::{self, Tx};
use atsam3x8e_hal::{clock, watchdog};
// Its linker script.
use defmt as _;
use embedded_io::Write;

/// The sending side of the line.
pub struct Line(Tx);

impl Line {
    /// The chip at 84 MHz without its watchdog, and the line at 250 000 Bd.
    ///
    /// # Panics
    /// If the chip does not come up, or has a line already.
    pub fn open(device: Peripherals) -> Self {
        watchdog::disable(device.WDT);
        let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).expect("the crystal oscillates");
        let a = device.PIOA.split(clocks);
        let (rx, tx) = (a.pa8.into_peripheral_a(), a.pa9.into_peripheral_a());
        let sent = cortex_m::singleton!(: [u8; 256] = [0; 256]).expect("there is one line");
        let received = cortex_m::singleton!(: [u8; 16] = [0; 16]).expect("there is one line");
        let line = uart::new(device.UART, rx, tx, 250_000, sent, received, clocks);
        Self(line.expect("250 000 Bd is exact").0)
    }

    /// Marks the end of the output, and sleeps.
    pub fn close(mut self) -> ! {
        let Ok(()) = self.0.write_all(b"end\n");
        loop {
            cortex_m::asm::wfi();
        }
    }
}

impl fmt::Write for Line {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let written: Result<(), Infallible> = self.0.write_all(text.as_bytes());
        written.map_err(|never| match never {})
    }
}
