//! The I²C wires: levels of SDA and SCL as GPIOs drive them, and a bus without devices.

use sam3x_models::model::{Cycles, I2c};

/// The wires that GPIOs let rise.
#[derive(Debug, Clone)]
pub struct Wires {
    pub sda: bool,
    pub scl: bool,
}

impl Default for Wires {
    fn default() -> Self {
        Self { sda: true, scl: true }
    }
}

/// TWI0, whose wires end at the board's header.
#[derive(Debug, Clone)]
pub struct NoDevices;

impl I2c for NoDevices {
    fn start(&mut self, _address: u8, _read: bool, _now: Cycles) -> bool {
        false
    }

    fn write(&mut self, _byte: u8, _now: Cycles) -> bool {
        false
    }

    fn read(&mut self, _now: Cycles) -> u8 {
        0xFF
    }

    fn stop(&mut self, _now: Cycles) {}

    fn stretch(&mut self, _now: Cycles) -> Cycles {
        0
    }

    fn held(&mut self, _now: Cycles) -> (bool, bool) {
        (false, false)
    }

    fn pulse(&mut self, _now: Cycles) {}
}
