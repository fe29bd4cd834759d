//! I2C master at 400 kHz, interrupt-driven, every wait bounded in time.
//!
//! [`Twi`] implements `embedded_hal_async::i2c::I2c` for 7-bit addresses. The task bound to the peripheral's interrupt
//! calls [`on_interrupt`], which moves the bytes and wakes the waiting future.
//!
//! ```no_run
//! use atsam3x8e_hal::{clock, gpio::Split, pac, twi};
//! use embedded_hal_async::{delay::DelayNs, i2c::I2c};
//!
//! async fn read_chip_id(device: pac::Peripherals, delay: impl DelayNs) -> Result<u8, twi::Error> {
//!     let clocks = clock::configure(device.PMC, &device.EFC0, &device.EFC1).unwrap();
//!     let port_b = device.PIOB.split(clocks);
//!     let (sda, scl) = (port_b.pb12.into_peripheral_a(), port_b.pb13.into_peripheral_a());
//!     let mut i2c = twi::Twi::new(device.TWI1, sda, scl, delay, clocks);
//!     let mut id = [0];
//!     match i2c.write_read(0x28, &[0x00], &mut id).await {
//!         Err(twi::Error::Stuck) => i2c.recover()?, // a device holds the bus: clock it free
//!         result => result?,
//!     }
//!     Ok(id[0])
//! }
//!
//! // In the task bound to interrupt TWI1:
//! twi::on_interrupt::<pac::TWI1>();
//! ```
//!
//! # Supported transactions
//!
//! A transaction is one write, one read, or a write of 1 to 3 bytes and a read with a repeated start between: the chip
//! sends the written bytes as its "internal address" (datasheet chapter 33, internal address), and has no other repeated start. Anything else is
//! [`Error::Unsupported`]. One transfer has at most [`MAX_TRANSFER`] bytes.
//!
//! # Bounds
//!
//! A transfer has 400 µs plus 45 µs for each byte on the wire (twice the wire's time), measured by the delay that
//! [`Twi::new`] is given, so that a bus without any interrupt ends it too. A device may stretch the clock within that time.
//! After every error but [`Error::Stuck`] the peripheral is ready for the next transfer; [`Error::Stuck`] requires
//! [`Twi::recover`]. A future that is dropped before its end resets the peripheral.

use core::future::{Future, poll_fn};
use core::marker::PhantomData;
use core::pin::pin;
use core::task::Poll;

use embedded_hal::digital::PinState;
use embedded_hal::i2c::{ErrorType, Operation};
use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::i2c::I2c;

use crate::clock::{Clocks, MCK_HZ};
use crate::{gpio, reg};

mod error;
mod instance;
mod transfer;
mod waveform;

pub use error::Error;
pub use instance::Instance;
pub use transfer::MAX_TRANSFER;
pub use waveform::BUS_HZ;

use transfer::{Action, Transfer};
use waveform::CLOCK_WAVEFORM;

const CR_START: u32 = 1 << 0;
const CR_STOP: u32 = 1 << 1;
const CR_MSEN: u32 = 1 << 2;
const CR_SVDIS: u32 = 1 << 5;
const CR_SWRST: u32 = 1 << 7;
const MMR_MREAD: u32 = 1 << 12;

/// Half a period of the clock during recovery, 100 kHz: 5 µs.
const RECOVERY_HALF_PERIOD: u32 = MCK_HZ / 200_000;
/// A byte and its acknowledgement; a device that was interrupted in a byte releases SDA within them (I2C specification 3.1.16).
const RECOVERY_PULSES: u32 = 9;

/// An I2C master on TWI0 or TWI1.
#[derive(Debug)]
pub struct Twi<I: Instance, D> {
    delay: D,
    instance: PhantomData<I>,
}

impl<I: Instance, D: DelayNs> Twi<I, D> {
    /// Sets the peripheral up as a master at 400 kHz. `delay` bounds the transfers; [`crate::tc::Mono`] is one.
    ///
    /// The bus needs external pull-ups, as the Due has on SDA and SCL (D20, D21).
    pub fn new(_twi: I, _sda: I::Sda, _scl: I::Scl, delay: D, clocks: Clocks) -> Self {
        clocks.enable(I::INTERRUPT);
        set_up::<I>();
        Self { delay, instance: PhantomData }
    }

    /// Frees a bus on which a device holds SDA: at most 9 clock pulses at 100 kHz until SDA is high, a STOP condition, and
    /// the set-up of the peripheral (the chip has no bus clear; I2C specification 3.1.16).
    ///
    /// Blocks for at most 120 µs. A device that is cut off by a multiplexer must be connected first.
    ///
    /// # Errors
    ///
    /// [`Error::Stuck`]: a line is still low. Then only the device's reset or supply helps.
    pub fn recover(&mut self) -> Result<(), Error> {
        let port = gpio::port(I::PORT);
        let (sda, scl) = (1 << I::SDA, 1 << I::SCL);
        // Both lines released, as open drain, before the multiplexer gives them to the PIO.
        reg::set(&port.mder, sda | scl);
        gpio::drive(port, sda | scl, PinState::High);
        let half_period = || cortex_m::asm::delay(RECOVERY_HALF_PERIOD);
        half_period();

        for _ in 0..RECOVERY_PULSES {
            if port.pdsr.read().bits() & sda != 0 {
                break;
            }
            reg::set(&port.codr, scl);
            half_period();
            reg::set(&port.sodr, scl);
            half_period();
        }
        // STOP: SDA rises while SCL is high.
        reg::set(&port.codr, scl);
        reg::set(&port.codr, sda);
        half_period();
        reg::set(&port.sodr, scl);
        half_period();
        reg::set(&port.sodr, sda);
        half_period();

        gpio::select_peripheral(port, sda | scl, false);
        // The TWI's own output is open drain; the PIO's multi drive must be off (datasheet chapter 33, I/O lines).
        reg::set(&port.mddr, sda | scl);
        set_up::<I>();
        if I::lines_are_high() { Ok(()) } else { Err(Error::Stuck) }
    }

    /// Runs a transfer until its end or until its time is over.
    async fn run(&mut self, transfer: &Transfer, wire_bytes: usize) -> Result<(), Error> {
        if !self.lines_come_up().await {
            return Err(Error::Stuck);
        }
        match self.race(transfer, budget_us(wire_bytes)).await {
            Err(Error::Timeout) if !self.lines_come_up().await => Err(Error::Stuck),
            result => result,
        }
    }

    /// Lets the interrupt handler run a transfer against the clock.
    async fn race(&mut self, transfer: &Transfer, budget_us: u32) -> Result<(), Error> {
        // Leaving this function early, also by dropping its future, resets the peripheral.
        let guard = ResetOnDrop::<I>(PhantomData);
        start::<I>(transfer);
        let mut time_over = pin!(self.delay.delay_us(budget_us));
        let result = poll_fn(|context| {
            if let Some(result) = result::<I>(context.waker()) {
                return Poll::Ready(result);
            }
            time_over.as_mut().poll(context).map(|()| Err(Error::Timeout))
        })
        .await;
        // The chip has ended these with a STOP condition; all others are cut off.
        if matches!(result, Ok(()) | Err(Error::NackAddress | Error::NackData | Error::Nack)) {
            core::mem::forget(guard);
        }
        result
    }

    /// Waits until both lines are high; false if one stays low. The STOP condition after a NACK, or a line that was just
    /// released, may take a few microseconds.
    async fn lines_come_up(&mut self) -> bool {
        if !I::lines_are_high() {
            self.delay.delay_us(10).await;
        }
        I::lines_are_high()
    }

    async fn write_bytes(&mut self, address: u8, bytes: &[u8]) -> Result<(), Error> {
        let transfer = Transfer::write(address, bytes)?;
        self.run(&transfer, 1 + bytes.len()).await
    }

    async fn read_bytes(&mut self, address: u8, register: &[u8], bytes: &mut [u8]) -> Result<(), Error> {
        let transfer = Transfer::read(address, register, bytes.len())?;
        self.run(&transfer, 2 + register.len() + bytes.len()).await?;
        I::with_shared(|shared| {
            bytes.copy_from_slice(shared.transfer.received().get(..bytes.len())?);
            Some(())
        })
        .flatten()
        .ok_or(Error::Overrun)
    }
}

impl<I: Instance, D> ErrorType for Twi<I, D> {
    type Error = Error;
}

impl<I: Instance, D: DelayNs> I2c for Twi<I, D> {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        match operations {
            [Operation::Write(bytes)] => self.write_bytes(address, bytes).await,
            [Operation::Read(bytes)] => self.read_bytes(address, &[], bytes).await,
            [Operation::Write(register), Operation::Read(bytes)] if (1..=3).contains(&register.len()) => {
                self.read_bytes(address, register, bytes).await
            }
            _ => Err(Error::Unsupported),
        }
    }
}

/// Moves a byte of the transfer; called by the handler of the instance's interrupt.
pub fn on_interrupt<I: Instance>() {
    let twi = I::registers();
    let waker = I::with_shared(|shared| {
        // NACK, OVRE and ARBLST are cleared by this read (datasheet chapter 33, TWI_SR): one snapshot serves all decisions.
        let status = twi.sr.read().bits();
        match shared.transfer.next(status) {
            Action::Read { stop } => {
                // STOP comes before RHR is read: reading lets the last byte finish, and a STOP half a bit later would be
                // too late for it (datasheet chapter 33, master receiver mode).
                if stop {
                    reg::set(&twi.cr, CR_STOP);
                }
                let byte = twi.rhr.read().bits() as u8;
                shared.transfer.receive(byte);
            }
            Action::Write(byte) => reg::set(&twi.thr, u32::from(byte)),
            Action::Stop => reg::set(&twi.cr, CR_STOP),
            Action::None => {}
        }
        let enabled = shared.transfer.interrupts();
        reg::set(&twi.idr, !enabled);
        reg::set(&twi.ier, enabled);
        if shared.transfer.is_finished() { shared.waker.take() } else { None }
    });
    if let Some(waker) = waker.flatten() {
        waker.wake();
    }
}

/// Programs a transfer and starts it (datasheet chapter 33, master mode).
fn start<I: Instance>(transfer: &Transfer) {
    let twi = I::registers();
    I::with_shared(|shared| {
        shared.waker = None;
        shared.transfer = *transfer;
        let direction = if transfer.is_read() { MMR_MREAD } else { 0 };
        reg::set(&twi.mmr, u32::from(transfer.address()) << 16 | direction | transfer.internal_address_size() << 8);
        reg::set(&twi.iadr, transfer.internal_address());
        // Clears the status of an earlier transfer, whose NACK is not one of this.
        let _stale = (twi.sr.read(), twi.rhr.read());
        if transfer.is_read() {
            // A read of one byte needs its STOP at once.
            reg::set(&twi.cr, if transfer.length() == 1 { CR_START | CR_STOP } else { CR_START });
        } else if let Action::Write(first) = shared.transfer.first_byte() {
            // Writing THR is the START.
            reg::set(&twi.thr, u32::from(first));
        }
        reg::set(&twi.ier, shared.transfer.interrupts());
    });
}

/// Result of the transfer, if it has ended; otherwise stores the waker.
fn result<I: Instance>(waker: &core::task::Waker) -> Option<Result<(), Error>> {
    I::with_shared(|shared| {
        let result = shared.transfer.result();
        if result.is_none() {
            shared.waker = Some(waker.clone());
        }
        result
    })
    .flatten()
}

/// Resets the peripheral and sets it up; the pins are released meanwhile.
fn set_up<I: Instance>() {
    let twi = I::registers();
    I::with_shared(|shared| {
        reg::set(&twi.idr, !0);
        reg::set(&twi.cr, CR_SWRST);
        reg::set(&twi.cr, CR_MSEN | CR_SVDIS);
        reg::set(&twi.cwgr, CLOCK_WAVEFORM);
        let _stale = (twi.sr.read(), twi.rhr.read());
        shared.transfer = Transfer::IDLE;
        shared.waker = None;
    });
}

struct ResetOnDrop<I: Instance>(PhantomData<I>);

impl<I: Instance> Drop for ResetOnDrop<I> {
    fn drop(&mut self) {
        set_up::<I>();
    }
}

/// Time a transfer may take: twice what its bytes need at 22.5 µs each, and 400 µs for clock stretching.
fn budget_us(wire_bytes: usize) -> u32 {
    400 + 45 * wire_bytes as u32
}

#[cfg(test)]
mod tests;
