//! Errors of the I2C master.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};

/// Errors of a transaction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No device acknowledged the address.
    #[error("no device acknowledged the address: is it wired and powered?")]
    NackAddress,
    /// The device refused a byte of data.
    #[error("the device did not acknowledge a byte")]
    NackData,
    /// The device acknowledged neither address nor register; the chip does not distinguish them.
    #[error("the device did not acknowledge its address or register")]
    Nack,
    /// Another master, or a disturbance, took the bus.
    #[error("bus arbitration lost: is there another master, or noise?")]
    ArbitrationLost,
    /// A byte was received before the previous one was read.
    #[error("a received byte was overwritten: the TWI interrupt came too late")]
    Overrun,
    /// The transfer did not end in its time; the lines are free.
    #[error("the transfer did not end in time")]
    Timeout,
    /// SDA or SCL is held low.
    #[error("a device holds SDA or SCL low: call recover")]
    Stuck,
    /// More bytes than the driver's buffer holds.
    #[error("a transfer has at most 32 bytes")]
    TooLong,
    /// A transaction that the chip cannot do.
    #[error("only a write, a read, or a write of 1 to 3 bytes and a read are possible, none of them empty")]
    Unsupported,
}

impl embedded_hal::i2c::Error for Error {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NackAddress => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Self::NackData => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data),
            Self::Nack => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown),
            Self::ArbitrationLost => ErrorKind::ArbitrationLoss,
            Self::Overrun => ErrorKind::Overrun,
            Self::Stuck => ErrorKind::Bus,
            Self::Timeout | Self::TooLong | Self::Unsupported => ErrorKind::Other,
        }
    }
}
