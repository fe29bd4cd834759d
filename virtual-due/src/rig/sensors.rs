//! The devices on TWI1: the multiplexer and, behind it, the IMUs.

use super::bno055::Bno055;
use super::faults::{Faults, ImuFault};
use super::tca9548a::Tca9548a;
use board_table::{ImuAddress, Wiring};
use rig_twin::PerSegment;
use sam3x_models::model::Cycles;

/// The devices, and those that the master has addressed.
#[derive(Debug, Clone)]
pub struct Sensors {
    pub mux: Tca9548a,
    /// IMU of each segment that has one.
    units: PerSegment<Option<Unit>>,
    mux_addressed: bool,
}

/// One IMU behind the multiplexer.
#[derive(Debug, Clone)]
struct Unit {
    place: ImuAddress,
    imu: Bno055,
    powered: bool,
    /// The orientation that a frozen unit keeps showing.
    last_orientation: [i16; 4],
    addressed: bool,
}

impl Unit {
    fn apply_power_fault(&mut self, fault: ImuFault, now: Cycles) {
        let has_power = fault != ImuFault::Unplugged;
        if has_power && !self.powered {
            self.imu = Bno055::powered(now);
        }
        self.powered = has_power;
    }

    /// Handles an address on the bus, with these channels connected.
    fn start(&mut self, (address, read): (u8, bool), connected: u8, orientation: [i16; 4], now: Cycles) {
        let is_called = address == self.place.address && connected >> self.place.channel & 1 == 1;
        self.addressed = is_called && self.powered && self.imu.answers(now);
        if self.addressed {
            self.last_orientation = orientation;
            self.imu.start(read, orientation, now);
        }
    }
}

impl Sensors {
    /// All powered at time 0.
    pub fn new(wiring: &Wiring, orientations: PerSegment<Option<[i16; 4]>>) -> Self {
        let unit = |(segment, orientation): (usize, Option<[i16; 4]>)| {
            Some(Unit {
                place: wiring.segments.get(segment)?.imu?,
                imu: Bno055::powered(0),
                powered: true,
                last_orientation: orientation?,
                addressed: false,
            })
        };
        let units = orientations.into_iter().enumerate().map(unit).collect();
        Self { mux: Tca9548a::default(), units, mux_addressed: false }
    }

    /// Switches the units' power according to the faults.
    pub fn apply_power_faults(&mut self, faults: &Faults, now: Cycles) {
        for (unit, fault) in self.units.iter_mut().zip(&faults.imus) {
            if let Some(unit) = unit {
                unit.apply_power_fault(*fault, now);
            }
        }
    }

    /// Resets the IMU of a segment, if it has one.
    pub fn brown_out(&mut self, segment: usize, now: Cycles) {
        if let Some(Some(unit)) = self.units.get_mut(segment) {
            unit.imu.brown_out(now);
        }
    }

    /// Handles a start condition and an address. All units on connected channels receive it: their open drains make a wired
    /// AND.
    pub fn start(
        &mut self,
        address: u8,
        read: bool,
        now: Cycles,
        orientations: &[Option<[i16; 4]>],
        faults: &Faults,
    ) -> bool {
        self.mux_addressed = address == Tca9548a::ADDRESS && self.mux.answers(faults.mux);
        let connected = self.mux.connected();
        for ((unit, orientation), fault) in self.units.iter_mut().zip(orientations).zip(&faults.imus) {
            if let Some(unit) = unit {
                let is_frozen = *fault == ImuFault::Frozen;
                let orientation = orientation.filter(|_| !is_frozen).unwrap_or(unit.last_orientation);
                unit.start((address, read), connected, orientation, now);
            }
        }
        self.mux_addressed || self.addressed().next().is_some()
    }

    /// The addressed units.
    fn addressed(&mut self) -> impl Iterator<Item = &mut Bno055> {
        self.units.iter_mut().flatten().filter(|unit| unit.addressed).map(|unit| &mut unit.imu)
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
        self.units.iter_mut().flatten().for_each(|unit| unit.addressed = false);
        self.mux.stop();
    }

    /// Time for which the slowest device holds the clock low.
    pub fn stretch(&mut self) -> Cycles {
        self.addressed().map(Bno055::stretch).max().unwrap_or(0)
    }
}
