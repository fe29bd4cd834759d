//! The devices on TWI1: the multiplexer and, behind it, the IMUs.

use super::bno055::Bno055;
use super::faults::MuxFault;
use super::tca9548a::Tca9548a;
use board_table::{ImuAddress, Wiring};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
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
pub struct Unit {
    place: ImuAddress,
    pub imu: Bno055,
    pub powered: bool,
    /// Share of the addresses that are not acknowledged.
    pub nack_share: f64,
    /// Time for which a fault holds the clock low.
    pub stretch: Cycles,
    /// The last orientation that the twin gave.
    last_orientation: [i16; 4],
    addressed: bool,
    random: ChaCha8Rng,
}

impl Unit {
    /// Handles an address on the bus, with these channels connected.
    fn start(&mut self, (address, read): (u8, bool), connected: u8, orientation: Option<[i16; 4]>, now: Cycles) {
        let is_called = address == self.place.address && connected >> self.place.channel & 1 == 1;
        self.addressed = is_called && self.powered && self.imu.answers(now) && !self.is_refused();
        if self.addressed {
            self.last_orientation = orientation.unwrap_or(self.last_orientation);
            self.imu.start(read, self.last_orientation, now);
        }
    }

    /// Draws whether a fault refuses an address.
    fn is_refused(&mut self) -> bool {
        self.nack_share > 0.0 && f64::from(self.random.next_u32()) < self.nack_share * f64::from(u32::MAX)
    }

    /// Time for which it holds the clock low before the next byte.
    fn stretch(&mut self) -> Cycles {
        let own = self.imu.stretch();
        if own > 0 { own.max(self.stretch) } else { 0 }
    }
}

impl Sensors {
    /// All powered at time 0; the seed is that of faults at random.
    pub fn new(wiring: &Wiring, orientations: PerSegment<Option<[i16; 4]>>, seed: u64) -> Self {
        let unit = |(segment, orientation): (usize, Option<[i16; 4]>)| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(1 + segment as u64);
            Some(Unit {
                place: wiring.segments.get(segment)?.imu?,
                imu: Bno055::powered(0),
                powered: true,
                nack_share: 0.0,
                stretch: 0,
                last_orientation: orientation?,
                addressed: false,
                random,
            })
        };
        let units = orientations.into_iter().enumerate().map(unit).collect();
        Self { mux: Tca9548a::default(), units, mux_addressed: false }
    }

    /// The IMU of a segment, if it has one.
    pub fn unit(&mut self, segment: usize) -> Option<&mut Unit> {
        self.units.get_mut(segment)?.as_mut()
    }

    /// The supply of all devices was cut, and returns at `now`.
    pub fn cut_power(&mut self, now: Cycles) {
        self.mux = Tca9548a::default();
        self.units.iter_mut().flatten().for_each(|unit| unit.imu.power_returns(now));
    }

    /// Handles a start condition and an address. All units on connected channels receive it: their open drains make a wired
    /// AND.
    pub fn start(
        &mut self,
        address: u8,
        read: bool,
        now: Cycles,
        orientations: &[Option<[i16; 4]>],
        mux_fault: Option<MuxFault>,
    ) -> bool {
        self.mux_addressed = address == Tca9548a::ADDRESS && self.mux.answers(mux_fault);
        let connected = self.mux.connected();
        for (unit, orientation) in self.units.iter_mut().zip(orientations) {
            if let Some(unit) = unit {
                unit.start((address, read), connected, *orientation, now);
            }
        }
        self.mux_addressed || self.addressed().next().is_some()
    }

    /// The addressed units.
    fn addressed(&mut self) -> impl Iterator<Item = &mut Unit> {
        self.units.iter_mut().flatten().filter(|unit| unit.addressed)
    }

    /// Writes a byte to the addressed devices; true if one acknowledged.
    pub fn write(&mut self, byte: u8, now: Cycles, mux_fault: Option<MuxFault>) -> bool {
        if self.mux_addressed {
            self.mux.write(byte, mux_fault);
        }
        let mut acknowledged = self.mux_addressed;
        for unit in self.addressed().filter(|unit| unit.imu.answers(now)) {
            unit.imu.write(byte, now);
            acknowledged = true;
        }
        acknowledged
    }

    /// Reads a byte from the addressed devices; a line that no device pulls is high.
    pub fn read(&mut self) -> u8 {
        let from_mux = if self.mux_addressed { self.mux.read() } else { 0xFF };
        self.addressed().fold(from_mux, |wires, unit| wires & unit.imu.read())
    }

    /// A stop condition.
    pub fn stop(&mut self) {
        self.mux_addressed = false;
        self.units.iter_mut().flatten().for_each(|unit| unit.addressed = false);
        self.mux.stop();
    }

    /// Time for which the slowest device holds the clock low.
    pub fn stretch(&mut self) -> Cycles {
        self.addressed().map(Unit::stretch).max().unwrap_or(0)
    }
}
