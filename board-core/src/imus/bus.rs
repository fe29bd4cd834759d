//! The bus and its multiplexer, shared by the IMUs: polls, and recovery of the bus.

use crate::bno055::{Answer, Bno055};
use crate::tca9548a::{Channel, MuxError, Tca9548a};
use core::future::Future;
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::{Error, ErrorKind};
use embedded_hal_async::i2c::I2c;

/// A line of the bus stays low.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a line of the I2C bus stays low after nine clocks: look for a short or a device without supply")]
pub struct BusStuck;

/// An I²C controller that can free its bus from a device that holds SDA low.
pub trait BusRecovery {
    /// Aborts the controller's transfer, clocks the bus up to nine times, sends a STOP (UM10204, 3.1.16), and sets the
    /// controller up again. Takes bounded time and may be dropped; harmless on a bus that is free.
    ///
    /// # Errors
    ///
    /// [`BusStuck`] if SDA or SCL is still low.
    fn recover(&mut self) -> impl Future<Output = Result<(), BusStuck>>;
}

/// Result of polling an IMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Poll {
    /// The IMU answered.
    Data(Answer),
    /// The IMU does not acknowledge.
    Nack,
    /// The bus failed in the IMU's transaction.
    BusError,
    /// The multiplexer failed.
    MuxError,
}

#[derive(Debug)]
pub(super) struct Bus<I, R> {
    i2c: I,
    mux: Tca9548a<R>,
    /// A transaction was cut off or ended in a bus error, and the bus was not recovered since.
    needs_recovery: bool,
    /// Recovered, not yet confirmed by an answer.
    recovery_unconfirmed: bool,
    /// Recovery confirmed, event not yet sent.
    recovery_to_report: bool,
    recoveries: u32,
}

impl<I: I2c + BusRecovery, R: OutputPin> Bus<I, R> {
    pub(super) fn new(i2c: I, mux: Tca9548a<R>) -> Self {
        Self { i2c, mux, needs_recovery: false, recovery_unconfirmed: false, recovery_to_report: false, recoveries: 0 }
    }

    /// Polls `imu` on `channel`: one step of its driver.
    pub(super) async fn poll(&mut self, imu: &mut Bno055, channel: Channel, tick: u32) -> Poll {
        self.needs_recovery = true;
        let step = async |i2c: &mut I| imu.step(i2c, tick).await;
        let poll = match self.mux.with_channel(&mut self.i2c, channel, step).await {
            Ok(answer) => Poll::Data(answer),
            Err(MuxError::Device(error)) if matches!(error.kind(), ErrorKind::NoAcknowledge(_)) => Poll::Nack,
            Err(MuxError::Device(_)) => return Poll::BusError,
            Err(MuxError::Mux(_) | MuxError::NotTaken(_)) => return Poll::MuxError,
        };
        self.needs_recovery = false;
        if core::mem::take(&mut self.recovery_unconfirmed) {
            self.recovery_to_report = true;
            self.recoveries = self.recoveries.saturating_add(1);
        }
        poll
    }

    /// Returns whether the bus must be recovered before the next poll.
    pub(super) fn needs_recovery(&self) -> bool {
        self.needs_recovery
    }

    /// Recovers the bus and disconnects all channels; false if a line stays low.
    ///
    /// A device can only be clocked free while its channel is connected, so that the clocks come first. A device that
    /// they do not free is disconnected with its channel.
    pub(super) async fn recover(&mut self) -> bool {
        let freed = self.i2c.recover().await.is_ok();
        // After a failure of the pin the multiplexer's channel stays unknown.
        let _ = self.mux.reset();
        let is_free = freed || self.i2c.recover().await.is_ok();
        self.needs_recovery = !is_free;
        self.recovery_unconfirmed |= is_free;
        is_free
    }

    /// Returns whether a recovery was confirmed since the last call.
    pub(super) fn take_recovery(&mut self) -> bool {
        core::mem::take(&mut self.recovery_to_report)
    }

    pub(super) fn recoveries(&self) -> u32 {
        self.recoveries
    }
}
