//! State of the twelve bend sensors, from their raw counts.
//!
//! A bend sensor is a strip of 25 kΩ to 100 kΩ to ground and a fixed 47 kΩ to the converter's reference, so that it
//! reads 1400 to 2800 of 4095 counts. An open strip reads the reference, a short or an open resistor reads ground. The
//! rail bands of [`RAIL_COUNTS`] (26 mV) at both ends stand for less than 370 Ω and for more than 5.9 MΩ: no strip comes
//! near, and noise of 2 counts does not lead out of them.
//!
//! | in a tick | what the estimator gets | state |
//! |---|---|---|
//! | counts between the bands | the counts, unless off | ok again after [`RETURN_TICKS`] in a row |
//! | counts in a band, or not read | nothing | off after [`LOSS_TICKS`] in a row |
//!
//! A scan that was late or out of order counts as not read, for all sensors. Sensors start as ok.

use telemetry::{BEND_SENSORS, Event, SensorHealth, SensorState};

/// Width of the bands at both ends of the converter's range, counts.
pub const RAIL_COUNTS: u16 = 32;

/// Ticks of 10 ms in a row without a good reading after which a sensor is off.
pub const LOSS_TICKS: u8 = 3;

/// Ticks of 10 ms in a row with a good reading after which a sensor is ok again.
pub const RETURN_TICKS: u8 = 50;

/// Bend sensors of a segment.
const PER_SEGMENT: usize = BEND_SENSORS / telemetry::SEGMENTS;

/// Largest count of the converter: 12 bits, below the 4 of the channel's tag (datasheet 43.6.11).
const MAX_COUNTS: u16 = 4095;

/// The twelve bend sensors, in the order 1a, 1b, 2a … 6b.
///
/// ```
/// use board_core::Bends;
///
/// let mut bends = Bends::new();
/// let mut scan = [2000; 12];
/// scan[4] = 4095; // 3a is open
/// let counts = bends.step(Some(&scan), |_| {});
/// assert_eq!((counts[3], counts[4]), (Some(2000), None));
/// ```
#[derive(Debug)]
pub struct Bends {
    sensors: [Sensor; BEND_SENSORS],
}

impl Bends {
    /// All sensors ok, none missed.
    pub const fn new() -> Self {
        let ok = SensorHealth { state: SensorState::Ok, missed: 0 };
        Self { sensors: [Sensor { health: ok, run: 0 }; BEND_SENSORS] }
    }

    /// Takes over the scan of a tick, `None` if it was late or out of order; gives the counts to trust, and says each
    /// change of a sensor's state.
    pub fn step(
        &mut self,
        scan: Option<&[u16; BEND_SENSORS]>,
        mut say: impl FnMut(Event),
    ) -> [Option<u16>; BEND_SENSORS] {
        let mut counts = scan.map_or([None; BEND_SENSORS], |scan| scan.map(Some));
        for ((index, sensor), counts) in (0..).zip(&mut self.sensors).zip(&mut counts) {
            let before = sensor.health.state;
            *counts = sensor.step(*counts);
            if sensor.health.state != before {
                say(Event::Bend(index, sensor.health.state));
            }
        }
        counts
    }

    /// State of each sensor, and how many ticks it gave nothing.
    pub fn health(&self) -> [SensorHealth; BEND_SENSORS] {
        self.sensors.map(|sensor| sensor.health)
    }

    /// Whether all bend sensors of a segment, counted from 0 at the base, are off.
    pub fn segment_is_lost(&self, segment: usize) -> bool {
        let mut sensors = self.sensors.iter().skip(segment * PER_SEGMENT).take(PER_SEGMENT);
        sensors.all(|sensor| sensor.health.state == SensorState::Off)
    }
}

impl Default for Bends {
    fn default() -> Self {
        Self::new()
    }
}

#[derive(Debug, Clone, Copy)]
struct Sensor {
    health: SensorHealth,
    /// Ticks in a row that speak against the state.
    run: u8,
}

impl Sensor {
    fn step(&mut self, counts: Option<u16>) -> Option<u16> {
        let good = counts.filter(|counts| (RAIL_COUNTS..=MAX_COUNTS - RAIL_COUNTS).contains(counts));
        let (other, ticks) = match self.health.state {
            SensorState::Off => (SensorState::Ok, RETURN_TICKS),
            _ => (SensorState::Off, LOSS_TICKS),
        };
        let against = good.is_some() == (other == SensorState::Ok);
        self.run = if against { self.run.saturating_add(1) } else { 0 };
        if self.run >= ticks {
            self.health.state = other;
            self.run = 0;
        }
        let trusted = good.filter(|_| self.health.state == SensorState::Ok);
        if trusted.is_none() {
            self.health.missed = self.health.missed.saturating_add(1);
        }
        trusted
    }
}
