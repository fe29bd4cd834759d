//! SDA, SCL and RESET: as the TWI uses them, and as a firmware moves them by hand.

use super::{Held, Rig};
use sam3x_models::model::{Cycles, I2c};

/// Whether a GPIO lets the wires rise.
#[derive(Debug, Clone)]
pub struct Wires {
    sda: bool,
    scl: bool,
}

impl Default for Wires {
    fn default() -> Self {
        Self { sda: true, scl: true }
    }
}

/// TWI0's wires end at the board's header.
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

impl I2c for Rig {
    fn start(&mut self, address: u8, read: bool, now: Cycles) -> bool {
        self.advance_to(now);
        let orientations = self.arm.twin().imu_quaternions();
        self.sensors.start(address, read, now, orientations, &self.faults)
    }

    fn write(&mut self, byte: u8, now: Cycles) -> bool {
        self.advance_to(now);
        self.sensors.write(byte, now, &self.faults)
    }

    fn read(&mut self, now: Cycles) -> u8 {
        self.advance_to(now);
        if self.faults.sda.is_some() { 0 } else { self.sensors.read() }
    }

    fn stop(&mut self, now: Cycles) {
        self.advance_to(now);
        self.sensors.stop();
    }

    fn stretch(&mut self, _now: Cycles) -> Cycles {
        self.sensors.stretch()
    }

    fn held(&mut self, _now: Cycles) -> (bool, bool) {
        (self.faults.scl.is_some(), self.faults.sda.is_some())
    }

    /// A clock pulse frees a line that is held for a number of them.
    fn pulse(&mut self, _now: Cycles) {
        self.faults.sda = self.faults.sda.and_then(Held::clocked);
        self.faults.scl = self.faults.scl.and_then(Held::clocked);
    }
}

impl Rig {
    /// SDA that rises while SCL is high is a stop condition.
    pub(super) fn drive_sda(&mut self, level: Option<bool>) {
        let high = level.unwrap_or(true);
        if high && !self.wires.sda && self.wires.scl && self.faults.sda.is_none() {
            self.sensors.stop();
        }
        self.wires.sda = high;
    }

    /// Each rise of SCL is a clock pulse.
    pub(super) fn drive_scl(&mut self, level: Option<bool>, now: Cycles) {
        let high = level.unwrap_or(true);
        if high && !self.wires.scl {
            self.pulse(now);
        }
        self.wires.scl = high;
    }

    /// RESET low disconnects all channels and ends what can be ended by it.
    pub(super) fn drive_mux_reset(&mut self, level: Option<bool>) {
        let low = level == Some(false);
        self.sensors.mux.set_reset(low);
        if low {
            self.faults.mux = None;
            self.faults.sda = self.faults.sda.filter(|held| *held != Held::UntilMuxReset);
            self.faults.scl = self.faults.scl.filter(|held| *held != Held::UntilMuxReset);
        }
    }
}
