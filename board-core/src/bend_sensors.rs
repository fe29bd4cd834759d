//! Monitor of the twelve bend sensors: rail detection in the raw counts, and a debounced state of each sensor.
//!
//! A bend sensor is a strip of 25 kΩ to 100 kΩ to ground and a fixed 47 kΩ to the converter's reference, so that it
//! reads 1400 to 2800 of 4095 counts. An open strip reads the reference, a short or an open resistor reads ground. The
//! rail bands of [`RAIL_COUNTS`] (26 mV) at both ends stand for less than 370 Ω and for more than 5.9 MΩ: no strip comes
//! near, and noise of 2 counts does not leave them.
//!
//! | reading of a tick | input of the estimator | state |
//! |---|---|---|
//! | counts between the bands | the counts, if the state is ok | ok again after [`RETURN_TICKS`] in a row |
//! | counts in a band, or not read | none | no response after [`LOSS_TICKS`] in a row |
//!
//! A scan that was late or out of order counts as not read, for all sensors. Sensors start as ok.

use telemetry::{BEND_SENSORS, Event, SensorHealth, SensorState};

/// Width of the bands at both ends of the converter's range, counts.
pub const RAIL_COUNTS: u16 = 32;

/// Debounce time of a loss: ticks of 10 ms in a row without a good reading.
pub const LOSS_TICKS: u8 = 3;

/// Debounce time of a return: ticks of 10 ms in a row with a good reading.
pub const RETURN_TICKS: u8 = 50;

/// Bend sensors of a segment.
const PER_SEGMENT: usize = BEND_SENSORS / telemetry::SEGMENTS;

/// Largest count of the converter: 12 bits, below the 4 of the channel's tag (datasheet 43.6.11).
const MAX_COUNTS: u16 = 4095;

/// Monitor of the twelve bend sensors, in the order 1a, 1b, 2a … 6b.
///
/// ```
/// use board_core::BendSensorMonitor;
///
/// let mut monitor = BendSensorMonitor::new();
/// let mut scan = [2000; 12];
/// scan[4] = 4095; // 3a is open
/// let counts = monitor.step(Some(&scan), |_| {});
/// assert_eq!((counts[3], counts[4]), (Some(2000), None));
/// ```
#[derive(Debug)]
pub struct BendSensorMonitor {
    sensors: [Sensor; BEND_SENSORS],
}

impl BendSensorMonitor {
    /// A monitor whose sensors are all ok.
    pub const fn new() -> Self {
        let ok = SensorHealth { state: SensorState::Ok, missed: 0 };
        Self { sensors: [Sensor { health: ok, debounce: 0 }; BEND_SENSORS] }
    }

    /// Checks the scan of a tick, `None` if it was late or out of order. Returns the valid counts and reports each change
    /// of a sensor's state.
    pub fn step(
        &mut self,
        scan: Option<&[u16; BEND_SENSORS]>,
        mut report: impl FnMut(Event),
    ) -> [Option<u16>; BEND_SENSORS] {
        let mut counts = scan.map_or([None; BEND_SENSORS], |scan| scan.map(Some));
        for ((index, sensor), counts) in (0..).zip(&mut self.sensors).zip(&mut counts) {
            let before = sensor.health.state;
            *counts = sensor.step(*counts);
            if sensor.health.state != before {
                report(Event::Bend(index, sensor.health.state));
            }
        }
        counts
    }

    /// State of each sensor, and its ticks without a valid reading.
    pub fn health(&self) -> [SensorHealth; BEND_SENSORS] {
        self.sensors.map(|sensor| sensor.health)
    }

    /// Returns whether no bend sensor of a segment, counted from 0 at the base, responds.
    pub fn segment_is_lost(&self, segment: usize) -> bool {
        let mut sensors = self.sensors.iter().skip(segment * PER_SEGMENT).take(PER_SEGMENT);
        sensors.all(|sensor| sensor.health.state == SensorState::NoResponse)
    }
}

impl Default for BendSensorMonitor {
    fn default() -> Self {
        Self::new()
    }
}

#[derive(Debug, Clone, Copy)]
struct Sensor {
    health: SensorHealth,
    /// Debounce counter: ticks in a row whose reading contradicts the state.
    debounce: u8,
}

impl Sensor {
    fn step(&mut self, counts: Option<u16>) -> Option<u16> {
        let good = counts.filter(|counts| (RAIL_COUNTS..=MAX_COUNTS - RAIL_COUNTS).contains(counts));
        let (other, ticks) = match self.health.state {
            SensorState::NoResponse => (SensorState::Ok, RETURN_TICKS),
            _ => (SensorState::NoResponse, LOSS_TICKS),
        };
        let contradicts = good.is_some() == (other == SensorState::Ok);
        self.debounce = if contradicts { self.debounce.saturating_add(1) } else { 0 };
        if self.debounce >= ticks {
            self.health.state = other;
            self.debounce = 0;
        }
        let valid = good.filter(|_| self.health.state == SensorState::Ok);
        if valid.is_none() {
            self.health.missed = self.health.missed.saturating_add(1);
        }
        valid
    }
}
