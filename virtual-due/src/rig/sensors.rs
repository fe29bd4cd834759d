//! The devices on TWI1: the multiplexer and, behind it, the IMUs.

use super::bno055::Bno055;
use super::faults::{Faults, ImuFault};
use super::tca9548a::Tca9548a;
use rig_twin::SEGMENTS;
use sam3x_models::model::Cycles;

/// The devices, and those that the master has addressed.
#[derive(Debug, Clone)]
pub struct Sensors {
    pub mux: Tca9548a,
    imus: [Bno055; SEGMENTS],
    powered: [bool; SEGMENTS],
    /// The orientations that frozen units keep showing.
    last_orientations: [[i16; 4]; SEGMENTS],
    mux_addressed: bool,
    imus_addressed: [bool; SEGMENTS],
}

impl Sensors {
    /// All powered at time 0.
    pub fn new(orientations: [[i16; 4]; SEGMENTS]) -> Self {
        Self {
            mux: Tca9548a::default(),
            imus: std::array::from_fn(|_| Bno055::powered(0)),
            powered: [true; SEGMENTS],
            last_orientations: orientations,
            mux_addressed: false,
            imus_addressed: [false; SEGMENTS],
        }
    }

    /// Switches the units' power according to the faults.
    pub fn apply_power_faults(&mut self, faults: &Faults, now: Cycles) {
        for ((imu, powered), fault) in self.imus.iter_mut().zip(&mut self.powered).zip(&faults.imus) {
            let has_power = *fault != ImuFault::Unplugged;
            if has_power && !*powered {
                *imu = Bno055::powered(now);
            }
            *powered = has_power;
        }
    }

    pub fn brown_out(&mut self, imu: usize, now: Cycles) {
        self.imus[imu].brown_out(now);
    }

    /// Handles a start condition and an address. All units on connected channels receive it: their open drains make a wired
    /// AND.
    pub fn start(
        &mut self,
        address: u8,
        read: bool,
        now: Cycles,
        orientations: [[i16; 4]; SEGMENTS],
        faults: &Faults,
    ) -> bool {
        self.mux_addressed = address == Tca9548a::ADDRESS && self.mux.answers(faults.mux);
        for (index, imu) in self.imus.iter_mut().enumerate() {
            let is_called = address == Bno055::ADDRESS && self.mux.connected() & (1 << index) != 0;
            let addressed = is_called && self.powered[index] && imu.answers(now);
            self.imus_addressed[index] = addressed;
            if addressed {
                if faults.imus[index] != ImuFault::Frozen {
                    self.last_orientations[index] = orientations[index];
                }
                imu.start(read, self.last_orientations[index], now);
            }
        }
        self.mux_addressed || self.imus_addressed.contains(&true)
    }

    /// The addressed units.
    fn addressed(&mut self) -> impl Iterator<Item = &mut Bno055> {
        self.imus.iter_mut().zip(&self.imus_addressed).filter(|(_, addressed)| **addressed).map(|(imu, _)| imu)
    }

    /// Writes a byte to the addressed devices; true if one acknowledged.
    pub fn write(&mut self, byte: u8, now: Cycles, faults: &Faults) -> bool {
        if self.mux_addressed {
            self.mux.write(byte, faults.mux);
        }
        let mut acknowledged = self.mux_addressed;
        for imu in self.addressed().filter(|imu| imu.answers(now)) {
            imu.write(byte, now);
            acknowledged = true;
        }
        acknowledged
    }

    /// Reads a byte from the addressed devices; a line that no device pulls is high.
    pub fn read(&mut self) -> u8 {
        let from_mux = if self.mux_addressed { self.mux.read() } else { 0xFF };
        self.addressed().fold(from_mux, |wires, imu| wires & imu.read())
    }

    /// A stop condition.
    pub fn stop(&mut self) {
        self.mux_addressed = false;
        self.imus_addressed = [false; SEGMENTS];
        self.mux.stop();
    }

    /// Time for which the slowest device holds the clock low.
    pub fn stretch(&mut self) -> Cycles {
        self.addressed().map(Bno055::stretch).max().unwrap_or(0)
    }
}
