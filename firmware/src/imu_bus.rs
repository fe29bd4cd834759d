//! TWI1 as the IMUs' bus of [`board_core`].

use atsam3x8e_hal::pac::TWI1;
use atsam3x8e_hal::tc::Mono;
use atsam3x8e_hal::twi::{Error, Twi};
use board_core::imus::{BusRecovery, BusStuck};
use embedded_hal_async::i2c::{ErrorType, I2c, Operation};

/// The bus of the multiplexer and the IMUs.
pub struct ImuBus(pub Twi<TWI1, Mono>);

impl ErrorType for ImuBus {
    type Error = Error;
}

impl I2c for ImuBus {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), Error> {
        self.0.transaction(address, operations).await
    }
}

impl BusRecovery for ImuBus {
    async fn recover(&mut self) -> Result<(), BusStuck> {
        self.0.recover().map_err(|_| BusStuck)
    }
}
