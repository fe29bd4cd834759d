//! Faults of sensors and recordings, put into sessions of the twin.
//!
//! The functions spoil samples from index `from` on. IMUs, segments and bend sensors are counted from 0; bend sensors in the
//! order 1a, 1b, 2a, … 6b.

use std::ops::Range;

use proprio_simulation::Recorded;
use rig_twin::{BEND_SENSORS, SEGMENTS};

/// The highest count of the converter.
const FULL_SCALE: u16 = 4095;

/// Samples of a session from the fault on.
#[derive(Debug)]
pub struct Spoiler<'s> {
    /// All samples.
    pub samples: &'s mut Vec<Recorded>,
    /// Index of the first that is spoiled.
    pub from: usize,
    /// Samples a second.
    pub rate_hz: f64,
}

impl Spoiler<'_> {
    fn steps(&self, seconds: f64) -> usize {
        (seconds * self.rate_hz).round() as usize
    }

    /// The samples from the fault on.
    fn after(&mut self) -> &mut [Recorded] {
        let from = self.from.min(self.samples.len());
        &mut self.samples[from..]
    }

    /// Those of the next `seconds`.
    fn next(&mut self, seconds: f64) -> &mut [Recorded] {
        let steps = self.steps(seconds);
        let after = self.after();
        let steps = steps.min(after.len());
        &mut after[..steps]
    }

    /// An IMU loses power: it is absent for the `gap_s` before, and returns with its zero turned.
    pub fn imu_restarts(&mut self, imu: usize, gap_s: f64, turn_deg: f64) {
        let gap = self.from.saturating_sub(self.steps(gap_s))..self.from;
        for sample in &mut self.samples[gap] {
            sample.quaternions[imu] = None;
        }
        self.heading_jumps(imu, turn_deg);
    }

    /// All IMUs restart at once, each to another zero.
    pub fn all_imus_restart(&mut self, gap_s: f64) {
        for imu in 0..SEGMENTS {
            self.imu_restarts(imu, gap_s, 40.0 * (imu + 1) as f64);
        }
    }

    /// An IMU does not answer any more.
    pub fn imu_dies(&mut self, imu: usize) {
        self.after().iter_mut().for_each(|sample| sample.quaternions[imu] = None);
    }

    /// An IMU repeats its last reading.
    pub fn imu_freezes(&mut self, imu: usize) {
        let held = self.after().first().and_then(|sample| sample.quaternions[imu]);
        self.after().iter_mut().for_each(|sample| sample.quaternions[imu] = held);
    }

    /// IMUs miss every third sample.
    pub fn imus_miss_every_third(&mut self, imus: Range<usize>) {
        for sample in self.after().iter_mut().step_by(3) {
            sample.quaternions[imus.clone()].fill(None);
        }
    }

    /// An IMU's heading jumps and stays there.
    pub fn heading_jumps(&mut self, imu: usize, turn_deg: f64) {
        self.after().iter_mut().for_each(|sample| turn(sample, imu, turn_deg));
    }

    /// An IMU's heading is off for `seconds`.
    pub fn heading_flickers(&mut self, imu: usize, turn_deg: f64, seconds: f64) {
        self.next(seconds).iter_mut().for_each(|sample| turn(sample, imu, turn_deg));
    }

    /// The rows of `seconds` before are missing.
    pub fn rows_missing(&mut self, seconds: f64) {
        let gap = self.from.saturating_sub(self.steps(seconds))..self.from;
        self.from = gap.start;
        self.samples.drain(gap);
    }

    /// A bend sensor opens: its divider reads one end of the converter's range.
    pub fn bend_opens(&mut self, sensor: usize, is_high: bool) {
        let counts = if is_high { FULL_SCALE } else { 0 };
        self.after().iter_mut().for_each(|sample| sample.counts[sensor] = Some(counts));
    }

    /// A bend sensor repeats its last reading.
    pub fn bend_freezes(&mut self, sensor: usize) {
        let held = self.after().first().and_then(|sample| sample.counts[sensor]);
        self.after().iter_mut().for_each(|sample| sample.counts[sensor] = held);
    }

    /// A bend sensor slips in its mount: its counts step.
    pub fn bend_steps(&mut self, sensor: usize, counts: f64) {
        self.after().iter_mut().for_each(|sample| shift(sample, sensor, counts));
    }

    /// A bend sensor's counts drift.
    pub fn bend_drifts(&mut self, sensor: usize, counts_per_s: f64) {
        let step = counts_per_s / self.rate_hz;
        for (k, sample) in self.after().iter_mut().enumerate() {
            shift(sample, sensor, step * k as f64);
        }
    }

    /// Bend sensors are not read any more.
    pub fn bend_sensors_missing(&mut self, is_missing: impl Fn(usize) -> bool) {
        for sensor in (0..BEND_SENSORS).filter(|sensor| is_missing(*sensor)) {
            self.after().iter_mut().for_each(|sample| sample.counts[sensor] = None);
        }
    }
}

/// Turns an IMU's heading clockwise.
fn turn(sample: &mut Recorded, imu: usize, turn_deg: f64) {
    let Some([w, x, y, z]) = sample.quaternions[imu].map(|quaternion| quaternion.map(f64::from)) else { return };
    let (sin, cos) = libm::sincos(-turn_deg.to_radians() / 2.0);
    let turned = [cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w];
    sample.quaternions[imu] = Some(turned.map(|component| component.round() as i16));
}

fn shift(sample: &mut Recorded, sensor: usize, counts: f64) {
    let shifted = |before: u16| (f64::from(before) + counts).round().clamp(0.0, f64::from(FULL_SCALE)) as u16;
    sample.counts[sensor] = sample.counts[sensor].map(shifted);
}

#[cfg(test)]
mod tests {
    use proprio_simulation::Simulation;
    use rig_twin::Scenario;

    use super::{Recorded, Spoiler};

    fn spoiled(spoil: fn(&mut Spoiler)) -> [Vec<Recorded>; 2] {
        let simulation = Simulation::new(Scenario::FreeSwing, 1, 10.0, 10.0).expect("a session");
        let clean: Vec<Recorded> = simulation.collect();
        let mut samples = clean.clone();
        spoil(&mut Spoiler { samples: &mut samples, from: 50, rate_hz: 10.0 });
        [clean, samples]
    }

    #[test]
    fn an_imu_is_absent_before_it_restarts_with_another_zero() {
        let [clean, samples] = spoiled(|spoiler| spoiler.imu_restarts(2, 0.7, 130.0));
        let is_absent = |k: usize| samples[k].quaternions[2].is_none();
        assert!((43..50).all(is_absent) && !is_absent(42) && !is_absent(50));
        assert_eq!(samples[42].quaternions, clean[42].quaternions);
        assert_ne!(samples[50].quaternions[2], clean[50].quaternions[2]);
        assert_eq!(samples[50].quaternions[3], clean[50].quaternions[3]);
    }

    #[test]
    fn missing_rows_end_where_the_fault_is_over() {
        let [clean, samples] = spoiled(|spoiler| spoiler.rows_missing(3.0));
        assert_eq!(samples.len(), clean.len() - 30);
        assert_eq!(samples[19].time_us, 1_900_000);
        assert_eq!(samples[20].time_us, 5_000_000);
    }

    #[test]
    fn a_drifting_bend_sensor_stops_at_the_end_of_the_converters_range() {
        let [clean, samples] = spoiled(|spoiler| spoiler.bend_drifts(4, 10_000.0));
        assert_eq!(samples[50].counts, clean[50].counts);
        assert_eq!(samples[99].counts[4], Some(4095));
        assert_eq!(samples[99].counts[5], clean[99].counts[5]);
    }
}
