//! The UART, both directions by PDC and without any interrupt.
//!
//! [`Tx`] takes whole frames or refuses them, and never waits for the line. [`Rx`] collects bytes in the background; a flood
//! of input costs no processor time until it is read. The PDC always has all queued bytes (as two runs), so that there is no
//! gap between frames and no work between calls.
//!
//! `embedded_io::Write` is implemented for [`Tx`]: it waits for room, at the line's speed. `embedded_io::Read` would have to
//! block until a byte is received, which is of no use here: call [`Rx::read`].
//!
//! ```no_run
//! use atsam3x8e_hal::{clock, gpio::Split, pac, uart};
//!
//! # fn buffer<const N: usize>() -> &'static mut [u8; N] { unimplemented!() }
//! let device = pac::Peripherals::take().unwrap();
//! let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).unwrap();
//! let port_a = device.PIOA.split(clocks);
//! let (rx_pin, tx_pin) = (port_a.pa8.into_peripheral_a(), port_a.pa9.into_peripheral_a());
//! let (tx_ring, rx_ring) = (buffer::<1024>(), buffer::<512>()); // `&'static mut [u8; N]`, as of RTIC's `local`
//! let (mut tx, mut rx) = uart::new(device.UART, rx_pin, tx_pin, 250_000, tx_ring, rx_ring, clocks)?;
//!
//! if tx.try_write_frame(b"hello\n").is_err() {
//!     // the ring is full: the frame is dropped as a whole
//! }
//! let mut bytes = [0; 64];
//! let count = rx.read(&mut bytes);
//! # let _ = count;
//! # Ok::<(), uart::Error>(())
//! ```

use core::convert::Infallible;

use embedded_io::{ErrorType, Write, WriteReady};

use crate::clock::Clocks;
use crate::gpio::{PeripheralA, Pin};
use crate::pdc::{Ring, Runs};
use crate::{pac, reg};

const CR_RSTRX_RSTTX: u32 = 1 << 2 | 1 << 3;
const CR_RXEN_TXEN: u32 = 1 << 4 | 1 << 6;
const CR_RSTSTA: u32 = 1 << 8;
/// PAR: no parity (datasheet chapter 34, UART_MR).
const MR_NO_PARITY: u32 = 0b100 << 9;
const SR_OVRE: u32 = 1 << 5;
const SR_FRAME: u32 = 1 << 6;
const SR_TXEMPTY: u32 = 1 << 9;
const PTCR_RXTEN: u32 = 1 << 0;
const PTCR_RXTDIS: u32 = 1 << 1;
const PTCR_TXTEN: u32 = 1 << 8;
const PTCR_TXTDIS: u32 = 1 << 9;

/// Why the UART was not set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The integer divider cannot make this baud rate to within 1 %.
    #[error("baud rate more than 1 % off: choose a divisor of 5.25 MBd, such as 250000")]
    BaudRate,
}

/// A frame was refused because the ring has no room for all of it. Nothing of it was queued.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the transmit ring has no room for the frame: drop it or try later")]
pub struct Full;

/// Sends bytes in the background.
#[derive(Debug)]
pub struct Tx {
    ring: Ring,
}

/// Receives bytes in the background.
#[derive(Debug)]
pub struct Rx {
    ring: Ring,
    /// Free bytes that the PDC was given last.
    granted: usize,
    overruns: u32,
    framing_errors: u32,
}

/// Sets the UART up with 8 data bits, no parity, 1 stop bit, and starts receiving.
///
/// The rings' memory belongs to the hardware from now on. A receive ring should hold what arrives between two calls of
/// [`Rx::read`], twice over; of a ring, at most 65535 bytes are used.
///
/// # Errors
///
/// [`Error::BaudRate`].
pub fn new(
    uart: pac::UART,
    _rx: Pin<'A', 8, PeripheralA>,
    _tx: Pin<'A', 9, PeripheralA>,
    baud: u32,
    tx_ring: &'static mut [u8],
    rx_ring: &'static mut [u8],
    clocks: Clocks,
) -> Result<(Tx, Rx), Error> {
    let divider = divider(clocks.mck(), baud).ok_or(Error::BaudRate)?;
    clocks.enable(pac::Interrupt::UART);
    reg::set(&uart.ptcr, PTCR_RXTDIS | PTCR_TXTDIS);
    reg::set(&uart.cr, CR_RSTRX_RSTTX);
    reg::set(&uart.idr, !0);
    reg::set(&uart.mr, MR_NO_PARITY);
    reg::set(&uart.brgr, divider);
    reg::set(&uart.cr, CR_RXEN_TXEN | CR_RSTSTA);

    let tx = Tx { ring: Ring::new(tx_ring) };
    // A boot loader may have left counters behind.
    tx.grant();
    let mut rx = Rx { ring: Ring::new(rx_ring), granted: 0, overruns: 0, framing_errors: 0 };
    rx.grant();
    Ok((tx, rx))
}

/// CD of a baud rate, MCK / (16 · CD) (datasheet chapter 34, UART_BRGR), if it comes within 1 %.
fn divider(mck: u32, baud: u32) -> Option<u32> {
    let sixteenth = mck / 16;
    let divider = sixteenth.checked_add(baud / 2)?.checked_div(baud)?;
    let actual = sixteenth.checked_div(divider)?;
    (divider <= 0xFFFF && actual.abs_diff(baud) <= baud / 100).then_some(divider)
}

fn registers() -> &'static pac::uart::RegisterBlock {
    // SAFETY: the UART is always there; `new` consumed it, and `Tx` and `Rx` write disjoint registers (in PTCR and CR,
    // which are write-only, disjoint bits).
    unsafe { &*pac::UART::ptr() }
}

impl Tx {
    /// Queues a whole frame, or nothing. Takes a few microseconds.
    ///
    /// # Errors
    ///
    /// [`Full`].
    pub fn try_write_frame(&mut self, frame: &[u8]) -> Result<(), Full> {
        if frame.len() > self.ring.free() && frame.len() > self.free() {
            return Err(Full);
        }
        self.with_pdc_paused(|ring| ring.write(frame));
        Ok(())
    }

    /// Bytes that [`Self::try_write_frame`] would take now.
    pub fn free(&mut self) -> usize {
        self.with_pdc_paused(|_| ());
        self.ring.free()
    }

    /// Returns whether all bytes are sent.
    pub fn is_idle(&mut self) -> bool {
        self.with_pdc_paused(|_| ());
        self.ring.length() == 0 && registers().sr.read().bits() & SR_TXEMPTY != 0
    }

    /// Pauses the PDC, removes the bytes that it has sent from the ring, calls `change`, and gives the PDC all queued bytes.
    ///
    /// The counters stand still while the transfer is disabled (datasheet 26.4.3), which is for less than the 80 µs that the
    /// UART's two holding stages last at 250 kBd: no gap.
    fn with_pdc_paused(&mut self, change: impl FnOnce(&mut Ring)) {
        critical_section::with(|_| {
            let uart = registers();
            reg::set(&uart.ptcr, PTCR_TXTDIS);
            let remaining = uart.tcr.read().bits() + uart.tncr.read().bits();
            self.ring.consumed(self.ring.length().saturating_sub(remaining as usize));
            change(&mut self.ring);
            self.grant();
        });
    }

    /// Gives the PDC the queued bytes and lets it run.
    fn grant(&self) {
        let Runs { offset, first, second } = self.ring.queued_runs();
        let uart = registers();
        // SAFETY: both runs lie in the ring's memory, which is never freed, and the PDC only reads it. This and the
        // following three writes give the transmitter exactly the queued bytes.
        unsafe { uart.tpr.write_with_zero(|w| w.bits(self.ring.address(offset))) };
        // SAFETY: as above.
        unsafe { uart.tcr.write_with_zero(|w| w.bits(first as u32)) };
        // SAFETY: as above.
        unsafe { uart.tnpr.write_with_zero(|w| w.bits(self.ring.address(0))) };
        // SAFETY: as above.
        unsafe { uart.tncr.write_with_zero(|w| w.bits(second as u32)) };
        reg::set(&uart.ptcr, PTCR_TXTEN);
    }
}

impl Rx {
    /// Reads the bytes received so far, at most as many as `bytes` holds, and returns their number. Never waits.
    pub fn read(&mut self, bytes: &mut [u8]) -> usize {
        self.collect();
        self.ring.read(bytes)
    }

    /// Losses of bytes because the ring was full, since the start; wraps.
    pub fn overruns(&self) -> u32 {
        self.overruns
    }

    /// Bytes without a stop bit (noise, or a wrong baud rate), since the start; wraps.
    pub fn framing_errors(&self) -> u32 {
        self.framing_errors
    }

    /// Adds the bytes that the PDC has received to the ring, and gives it all free bytes.
    ///
    /// The counters stand still while the transfer is disabled; the receiver's holding register bridges the pause.
    fn collect(&mut self) {
        critical_section::with(|_| {
            let uart = registers();
            reg::set(&uart.ptcr, PTCR_RXTDIS);
            let remaining = uart.rcr.read().bits() + uart.rncr.read().bits();
            self.ring.produced(self.granted.saturating_sub(remaining as usize));
            self.grant();
        });
        let status = registers().sr.read().bits();
        if status & (SR_OVRE | SR_FRAME) != 0 {
            self.overruns = self.overruns.wrapping_add(u32::from(status & SR_OVRE != 0));
            self.framing_errors = self.framing_errors.wrapping_add(u32::from(status & SR_FRAME != 0));
            reg::set(&registers().cr, CR_RSTSTA);
        }
    }

    /// Gives the PDC the free bytes and lets it run.
    fn grant(&mut self) {
        let Runs { offset, first, second } = self.ring.free_runs();
        let uart = registers();
        // SAFETY: both runs lie in the ring's memory, which is never freed, and in its free part, which the program does
        // not touch. This and the following three writes give the receiver exactly the free bytes.
        unsafe { uart.rpr.write_with_zero(|w| w.bits(self.ring.address(offset))) };
        // SAFETY: as above.
        unsafe { uart.rcr.write_with_zero(|w| w.bits(first as u32)) };
        // SAFETY: as above.
        unsafe { uart.rnpr.write_with_zero(|w| w.bits(self.ring.address(0))) };
        // SAFETY: as above.
        unsafe { uart.rncr.write_with_zero(|w| w.bits(second as u32)) };
        self.granted = first + second;
        reg::set(&uart.ptcr, PTCR_RXTEN);
    }
}

impl ErrorType for Tx {
    type Error = Infallible;
}

impl WriteReady for Tx {
    fn write_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.free() > 0)
    }
}

impl Write for Tx {
    /// Waits until there is room for at least one byte.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        if bytes.is_empty() {
            return Ok(0);
        }
        let mut room = self.free();
        while room == 0 {
            room = self.free();
        }
        let (now, _later) = bytes.split_at(bytes.len().min(room));
        self.with_pdc_paused(|ring| ring.write(now));
        Ok(now.len())
    }

    /// Waits until everything has left the chip.
    fn flush(&mut self) -> Result<(), Infallible> {
        while !self.is_idle() {}
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_of_a_megabaud_is_exact() {
        assert_eq!(divider(84_000_000, 250_000), Some(21));
        assert_eq!(84_000_000 / 16 / 21, 250_000);
    }

    #[test]
    fn a_baud_rate_that_the_divider_misses_by_more_than_a_percent_is_refused() {
        assert_eq!(divider(84_000_000, 115_200), Some(46));
        assert_eq!(divider(84_000_000, 500_000), None);
        assert_eq!(divider(84_000_000, 1_000_000), None);
        assert_eq!(divider(84_000_000, 0), None);
        assert_eq!(divider(84_000_000, u32::MAX), None);
        assert_eq!(divider(84_000_000, 50), None);
    }
}
