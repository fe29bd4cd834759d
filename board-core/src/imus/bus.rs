//! The bus and its multiplexer as the IMUs share them: who answered, and when the bus is to be cleared.

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
    /// Gives up what the controller was doing, clocks the bus up to nine times, sends a STOP (UM10204, 3.1.16), and sets
    /// the controller up again. Takes bounded time and may be dropped; harmless on a bus that is free.
    ///
    /// # Errors
    ///
    /// [`BusStuck`] where SDA or SCL is still low.
    fn recover(&mut self) -> impl Future<Output = Result<(), BusStuck>>;
}

/// What came of asking an IMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Asked {
    /// It answered.
    Answered(Answer),
    /// It does not acknowledge.
    Refused,
    /// The bus failed in its transaction.
    Failed,
    /// The multiplexer could not be spoken to.
    Unreached,
}

#[derive(Debug)]
pub(super) struct Bus<I, R> {
    i2c: I,
    mux: Tca9548a<R>,
    /// A transaction was cut off or ended in a bus error, and the bus was not cleared since.
    in_doubt: bool,
    /// The bus was cleared, and nobody has answered since.
    on_trial: bool,
    /// The bus was cleared and has proved good, and nobody was told.
    cleared: bool,
    recoveries: u32,
}

impl<I: I2c + BusRecovery, R: OutputPin> Bus<I, R> {
    pub(super) fn new(i2c: I, mux: Tca9548a<R>) -> Self {
        Self { i2c, mux, in_doubt: false, on_trial: false, cleared: false, recoveries: 0 }
    }

    /// Lets `imu`, which is on `channel`, make its step.
    pub(super) async fn ask(&mut self, imu: &mut Bno055, channel: Channel, tick: u32) -> Asked {
        self.in_doubt = true;
        let step = async |i2c: &mut I| imu.step(i2c, tick).await;
        let asked = match self.mux.with_channel(&mut self.i2c, channel, step).await {
            Ok(answer) => Asked::Answered(answer),
            Err(MuxError::Device(error)) if matches!(error.kind(), ErrorKind::NoAcknowledge(_)) => Asked::Refused,
            Err(MuxError::Device(_)) => return Asked::Failed,
            Err(MuxError::Mux(_) | MuxError::NotTaken(_)) => return Asked::Unreached,
        };
        self.in_doubt = false;
        if core::mem::take(&mut self.on_trial) {
            self.cleared = true;
            self.recoveries = self.recoveries.saturating_add(1);
        }
        asked
    }

    /// Whether the bus is to be cleared before anyone is asked.
    pub(super) fn is_in_doubt(&self) -> bool {
        self.in_doubt
    }

    /// Clears the bus and disconnects all channels; false where a line stays low.
    ///
    /// A device can only be clocked free while its channel is connected, so that the clocks come first. What they do not
    /// free is cut off with its channel.
    pub(super) async fn recover(&mut self) -> bool {
        let freed = self.i2c.recover().await.is_ok();
        // A pin that fails leaves the multiplexer as unknown as it was.
        let _ = self.mux.reset();
        let is_free = freed || self.i2c.recover().await.is_ok();
        self.in_doubt = !is_free;
        self.on_trial |= is_free;
        is_free
    }

    /// Whether the bus was cleared since the last call.
    pub(super) fn take_cleared(&mut self) -> bool {
        core::mem::take(&mut self.cleared)
    }

    pub(super) fn recoveries(&self) -> u32 {
        self.recoveries
    }
}
