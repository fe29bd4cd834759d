//! TCA9548A: the multiplexer that puts IMUs of one address on one bus.
//!
//! The connected channel is known only between successful transactions: [`Selected`] is `Unknown` from before each
//! transaction until it has succeeded, be it the multiplexer's or that of a device behind it. A future that is dropped in
//! between leaves it `Unknown` too. In that state all channels are deselected before one is selected, and each write of
//! the control register is read back, so that no reading is attributed to another channel: a multiplexer that lost its
//! supply or missed the write is detected before a device is read.
//!
//! A channel is connected at the STOP after the write (SCPS207F, 8.5.4); selecting and reading are therefore separate
//! transactions. A multiplexer that fails is reset by its RESET pin, which disconnects all channels in
//! any state of the bus (8.4.1).
//!
//! The published crate `xca9548a` 1.0 does not suit: it keeps its channel after an error, and then accesses
//! whichever device is connected.

use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::{Error, ErrorKind};
use embedded_hal_async::i2c::I2c;

/// The multiplexer's address with A0, A1 and A2 low.
pub const ADDRESS: u8 = 0x70;

/// One of the eight channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channel(u8);

impl Channel {
    /// Channels 0 … 7.
    pub const ALL: [Self; 8] = [Self(0), Self(1), Self(2), Self(3), Self(4), Self(5), Self(6), Self(7)];

    /// The channel's bit in the control register.
    const fn bit(self) -> u8 {
        1 << self.0
    }
}

/// Connected channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Selected {
    /// This channel alone.
    Channel(Channel),
    /// No channel.
    None,
    /// A transaction failed or was cut off: any set of channels.
    Unknown,
}

/// Error of an access to a device behind the multiplexer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MuxError<E> {
    /// The bus failed in a transaction of the multiplexer.
    #[error("the multiplexer does not answer: clear the bus and pulse the multiplexer's RESET")]
    Mux(E),
    /// The control register does not hold the written value.
    #[error("the multiplexer's control register reads {0:#010b}, not what was written: pulse its RESET")]
    NotTaken(u8),
    /// The bus failed once the channel was connected, or the device does not acknowledge.
    #[error("the device behind the multiplexer does not answer: check its supply and wires")]
    Device(E),
}

/// The multiplexer, with its RESET pin if that is wired.
#[derive(Debug)]
pub struct Tca9548a<R> {
    address: u8,
    reset: Option<R>,
    selected: Selected,
}

impl<R: OutputPin> Tca9548a<R> {
    /// The multiplexer at `address`, in any state. The RESET pin must be high.
    #[must_use]
    pub const fn new(address: u8, reset: Option<R>) -> Self {
        Self { address, reset, selected: Selected::Unknown }
    }

    /// Connected channels.
    #[must_use]
    pub const fn selected(&self) -> Selected {
        self.selected
    }

    /// Connects `channel` alone and runs `access` to the device behind it. Takes two short transactions in addition to those
    /// of `access`, four if the connected channel was not known, none if the channel is connected already.
    ///
    /// # Errors
    ///
    /// [`MuxError::Device`] is the device's or its channel's. After the others, recover the bus and call
    /// [`reset`](Self::reset). After each of them all channels are deselected before one is used.
    pub async fn with_channel<I: I2c, T>(
        &mut self,
        i2c: &mut I,
        channel: Channel,
        access: impl AsyncFnOnce(&mut I) -> Result<T, I::Error>,
    ) -> Result<T, MuxError<I::Error>> {
        if self.selected == Selected::Unknown {
            self.connect(i2c, Selected::None).await?;
        }
        if self.selected != Selected::Channel(channel) {
            self.connect(i2c, Selected::Channel(channel)).await?;
        }
        self.selected = Selected::Unknown;
        let answer = access(i2c).await.map_err(MuxError::Device)?;
        self.selected = Selected::Channel(channel);
        Ok(answer)
    }

    /// Disconnects all channels by the RESET pin; without one, marks the connected channels as unknown.
    ///
    /// # Errors
    ///
    /// The pin's error.
    pub fn reset(&mut self) -> Result<(), R::Error> {
        self.selected = Selected::Unknown;
        if let Some(pin) = &mut self.reset {
            // 6 ns of low are enough (6.7): less than two instructions of any board's.
            pin.set_low()?;
            pin.set_high()?;
            self.selected = Selected::None;
        }
        Ok(())
    }

    async fn connect<I: I2c>(&mut self, i2c: &mut I, wanted: Selected) -> Result<(), MuxError<I::Error>> {
        let control = if let Selected::Channel(channel) = wanted { channel.bit() } else { 0 };
        self.selected = Selected::Unknown;
        i2c.write(self.address, &[control]).await.map_err(MuxError::Mux)?;
        let mut taken = [0];
        i2c.read(self.address, &mut taken).await.map_err(|error| match (wanted, error.kind()) {
            // The write succeeded: the channel that it connected disturbs the bus.
            (Selected::Channel(_), kind) if !matches!(kind, ErrorKind::NoAcknowledge(_)) => MuxError::Device(error),
            _ => MuxError::Mux(error),
        })?;
        if taken != [control] {
            return Err(MuxError::NotTaken(taken[0]));
        }
        self.selected = wanted;
        Ok(())
    }
}
