//! Monitor of the bend sensors: rail detection in the raw counts, and a debounced state of each sensor.
//!
//! A bend sensor is a strip of 25 kΩ to 100 kΩ to ground and a fixed 47 kΩ to the converter's reference, so that it
//! reads 1400 to 2800 of 4095 counts. An open strip reads the reference, a short or an open resistor reads ground. The
//! rail bands of [`RAIL_COUNTS`] (26 mV) at both ends stand for less than 370 Ω and for more than 5.9 MΩ: no strip comes
//! near, and noise of 2 counts does not leave them.
//!
//! | reading of a tick | input of the estimator | state |
//! |---|---|---|
//! | counts between the bands | the counts, if it responds | responds again after [`RETURN_TICKS`] in a row |
//! | counts in a band, or not read | none | no response after [`LOSS_TICKS`] in a row, intermittent if more than one in twenty |
//! | counts that the estimator finds implausible | the counts | inconsistent |
//!
//! A scan that was late or out of order counts as not read, for all sensors. Sensors start as ok.

use board_table::{ANALOG_PINS, Wiring};
use heapless::Vec;
use telemetry::{BEND_PER_SEGMENT, Event, MAX_BEND_SENSORS, SensorHealth, SensorState, vector};

use crate::gap_counter::GapCounter;

/// Width of the bands at both ends of the converter's range, counts.
pub const RAIL_COUNTS: u16 = 32;

/// Debounce time of a loss: ticks of 10 ms in a row without a good reading.
pub const LOSS_TICKS: u8 = 3;

/// Debounce time of a return: ticks of 10 ms in a row with a good reading.
pub const RETURN_TICKS: u8 = 50;

/// Counts of a scan of all analog pins, A0 to A11.
pub type Scan = [u16; ANALOG_PINS as usize];

/// Health of a sensor that the arm does not have.
pub(crate) const NOT_WIRED: SensorHealth = SensorHealth { state: SensorState::NotWired, missed: 0 };

/// Largest count of the converter: 12 bits, below the 4 of the channel's tag (datasheet 43.6.11).
const MAX_COUNTS: u16 = 4095;

/// Monitor of the arm's bend sensors, two places for each segment: 1a, 1b, 2a, …
///
/// ```
/// use board_core::BendSensorMonitor;
/// use board_table::Wiring;
///
/// let mut monitor = BendSensorMonitor::new(&Wiring::reference(6));
/// let mut scan = [2000; 12];
/// scan[4] = 4095; // 3a is open
/// let counts = monitor.step(Some(&scan), |_| {});
/// assert_eq!((counts[3], counts[4]), (Some(2000), None));
/// ```
#[derive(Debug)]
pub struct BendSensorMonitor {
    sensors: Vec<Option<Sensor>, MAX_BEND_SENSORS>,
}

impl BendSensorMonitor {
    /// A monitor of the sensors that are wired, all ok.
    pub fn new(wiring: &Wiring) -> Self {
        let pins = wiring.segments.iter().flat_map(|segment| segment.bend);
        Self { sensors: vector(pins.map(|pin| pin.map(Sensor::new))) }
    }

    /// Checks the scan of a tick, `None` if it was late or out of order. Returns the valid counts and reports each change
    /// of a sensor's state.
    pub fn step(&mut self, scan: Option<&Scan>, mut report: impl FnMut(Event)) -> Vec<Option<u16>, MAX_BEND_SENSORS> {
        let sensors = self.sensors.iter_mut().zip(0..);
        let counts = sensors.map(|(sensor, index)| {
            let sensor = sensor.as_mut()?;
            let before = sensor.health.state;
            let counts = scan.and_then(|scan| scan.get(usize::from(sensor.pin)).copied());
            let counts = sensor.step(counts);
            if sensor.health.state != before {
                report(Event::Bend(index, sensor.health.state));
            }
            counts
        });
        vector(counts)
    }

    /// Takes the estimator's verdict on the counts of this tick: bit i of `implausible` is set if it leaves sensor i out.
    /// Reports each change of a sensor's state.
    pub fn set_implausible(&mut self, implausible: u16, mut report: impl FnMut(Event)) {
        for (index, sensor) in (0..).zip(&mut self.sensors) {
            let Some(sensor) = sensor else { continue };
            sensor.is_implausible = implausible >> index & 1 != 0;
            let state = sensor.health.state.judged(sensor.is_implausible);
            if core::mem::replace(&mut sensor.health.state, state) != state {
                report(Event::Bend(index, state));
            }
        }
    }

    /// State of each sensor, and its ticks without a valid reading.
    pub fn health(&self) -> Vec<SensorHealth, MAX_BEND_SENSORS> {
        vector(self.sensors.iter().map(|sensor| sensor.as_ref().map_or(NOT_WIRED, |sensor| sensor.health)))
    }

    /// Returns whether a segment, counted from 0 at the base, has bend sensors, and none of them responds.
    pub fn segment_is_lost(&self, segment: usize) -> bool {
        let sensors = || self.sensors.iter().skip(segment * BEND_PER_SEGMENT).take(BEND_PER_SEGMENT).flatten();
        sensors().next().is_some() && sensors().all(|sensor| sensor.health.state == SensorState::NoResponse)
    }
}

#[derive(Debug, Clone, Copy)]
struct Sensor {
    /// Analog pin.
    pin: u8,
    health: SensorHealth,
    responds: bool,
    /// Debounce counter: ticks in a row whose reading contradicts `responds`.
    debounce: u8,
    /// Gaps while it responds.
    gaps: GapCounter,
    /// The estimator leaves it out.
    is_implausible: bool,
}

impl Sensor {
    fn new(pin: u8) -> Self {
        let health = SensorHealth { state: SensorState::Ok, missed: 0 };
        Self { pin, health, responds: true, debounce: 0, gaps: GapCounter::default(), is_implausible: false }
    }

    fn step(&mut self, counts: Option<u16>) -> Option<u16> {
        let good = counts.filter(|counts| (RAIL_COUNTS..=MAX_COUNTS - RAIL_COUNTS).contains(counts));
        let contradicts = good.is_some() != self.responds;
        self.debounce = if contradicts { self.debounce.saturating_add(1) } else { 0 };
        if self.debounce >= if self.responds { LOSS_TICKS } else { RETURN_TICKS } {
            (self.responds, self.debounce, self.gaps) = (!self.responds, 0, GapCounter::default());
        }
        self.health.state = if !self.responds {
            SensorState::NoResponse
        } else if self.gaps.update(good.is_some()) {
            SensorState::Intermittent
        } else if self.is_implausible {
            SensorState::Inconsistent
        } else {
            SensorState::Ok
        };
        let valid = good.filter(|_| self.responds);
        if valid.is_none() {
            self.health.missed = self.health.missed.saturating_add(1);
        }
        valid
    }
}
