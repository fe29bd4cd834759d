//! Fault detection for the bend sensors of one segment, by comparison with each other and with the IMUs.
//!
//! Half the difference of a and b estimates the error of their mean in this session: where their slow errors are
//! independent, both have the same variance. A sensor that deviates from its twin and from the IMUs is excluded; the
//! reading of the other is then corrected by the running mean of the difference, so that the angle does not step.

use crate::config::{BendErrorConfig, SENSORS_PER_SEGMENT};
use crate::numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, is_beyond, magnitude, scaled_square, smaller};

/// Time over which the difference is averaged, time units: 60 s.
const DIFFERENCE_TIME: Constant = Constant::new(60.0 / TIME_UNIT_S);
/// Part of the slow difference that carries no information about the mean.
const IGNORED_DIFFERENCE: Constant = degrees(0.2);
/// A sensor is excluded for this time after its last deviation.
const DISTRUST_US: u64 = 20_000_000;
/// One over the threshold of the deviation from the IMUs, and from the twin (a margin subtracted first), in predicted
/// standard deviations.
const DEPARTURE: Constant = Constant::new(1.0 / 4.0);
const DIFFERENCE_DEPARTURE: Constant = Constant::new(1.0 / 5.0);
const DIFFERENCE_MARGIN: Constant = degrees(1.0);
/// The margin while the mean difference in this session is not known, that is in the tare and up to the sensors' first
/// comparison: twice the largest offset that storage or warmth was seen to give a sensor, 4°.
const UNKNOWN_DIFFERENCE_MARGIN: Constant = degrees(8.0);
/// A sensor is stuck if it moves by less than `STUCK` in 10 s while the IMUs move by more than `MOVING`.
const STUCK_US: u64 = 10_000_000;
const STUCK: Constant = degrees(1.0);
const MOVING: Constant = degrees(12.0);

/// A sensor steps if it moves by more than its errors allow, and by more than the IMUs, between two samples. The step
/// stays suspected down to half the limit, and is confirmed as a new zero after this time.
const STEP_CONFIRMATION_US: u64 = 350_000;
/// Time for which a new zero of a sensor is reported.
pub const NEW_ZERO_US: u64 = 60_000_000;
/// Longest time between two samples over which a step can be detected, time units: half a second.
const STEP_GAP: Constant = Constant::new(0.5 / TIME_UNIT_S);

/// State of a segment's bend sensors.
#[derive(Debug, Clone, Copy)]
pub struct BendMonitor<S> {
    steps: [StepDetector<S>; SENSORS_PER_SEGMENT],
    /// Mean of (a − b)/2 over the last minute, rad, and the averaging time so far, time units.
    difference: S,
    averaged: S,
    distrusted_until_us: [u64; SENSORS_PER_SEGMENT],
    /// Lowest and highest of θ and of each sensor since `range_from_us`.
    theta_range: [S; 2],
    sensor_ranges: [[S; 2]; SENSORS_PER_SEGMENT],
    range_from_us: u64,
}

/// Detector of a step of one sensor while the IMUs do not step: a slip on the arm, a bad contact.
#[derive(Debug, Clone, Copy)]
struct StepDetector<S> {
    /// Correction since the last step, rad.
    zero: S,
    /// Predicted angle: that of the last good sample plus the motion of the IMUs, rad.
    expected: Option<S>,
    suspect_since_us: Option<u64>,
    stepped_at_us: Option<u64>,
}

/// θ_bend of the sensors that are trusted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrustedBend<S> {
    /// Mean of the trusted sensors, rad.
    pub theta: S,
    /// One sensor of two is missing, so that its error does not cancel.
    pub is_single: bool,
}

impl<S: Scalar> BendMonitor<S> {
    /// At the start of a session. Not inlined, as the segments' initial values are then made by calls, not by code for
    /// each of them.
    #[inline(never)]
    pub const fn new(zero: S) -> Self {
        Self {
            steps: [StepDetector { zero, expected: None, suspect_since_us: None, stepped_at_us: None };
                SENSORS_PER_SEGMENT],
            difference: zero,
            averaged: zero,
            distrusted_until_us: [0; SENSORS_PER_SEGMENT],
            theta_range: [zero; 2],
            sensor_ranges: [[zero; 2]; SENSORS_PER_SEGMENT],
            range_from_us: 0,
        }
    }

    /// Angles of the sensors, corrected for the zeros that steps have changed.
    pub fn corrected(&self, angles: [Option<S>; SENSORS_PER_SEGMENT]) -> [Option<S>; SENSORS_PER_SEGMENT] {
        let [a, b] = angles;
        let [step_a, step_b] = &self.steps;
        [a.map(|a| a + step_a.zero), b.map(|b| b + step_b.zero)]
    }

    /// θ_bend of the sensors that are read and trusted; `None` without any. `has_twins`: the segment has two sensors.
    pub fn mean(
        &self,
        angles: [Option<S>; SENSORS_PER_SEGMENT],
        has_twins: bool,
        time_us: u64,
    ) -> Option<TrustedBend<S>> {
        match self.trusted(angles, time_us) {
            [Some(a), Some(b)] => Some(TrustedBend { theta: (a + b).half(), is_single: false }),
            [Some(a), None] => Some(TrustedBend { theta: a - self.difference, is_single: has_twins }),
            [None, Some(b)] => Some(TrustedBend { theta: b + self.difference, is_single: has_twins }),
            [None, None] => None,
        }
    }

    /// Averages the difference of both sensors, `dt` after the last sample.
    pub fn compare(&mut self, angles: [Option<S>; SENSORS_PER_SEGMENT], dt: S, time_us: u64) {
        if let [Some(a), Some(b)] = self.trusted(angles, time_us) {
            self.average_difference((a - b).half(), dt);
        }
    }

    fn trusted(&self, angles: [Option<S>; SENSORS_PER_SEGMENT], time_us: u64) -> [Option<S>; SENSORS_PER_SEGMENT] {
        let mut trusted = angles;
        for ((angle, until_us), step) in trusted.iter_mut().zip(self.distrusted_until_us).zip(&self.steps) {
            *angle = angle.filter(|_| time_us >= until_us && step.suspect_since_us.is_none());
        }
        trusted
    }

    /// Returns `true` while a sensor is excluded for a step that is not confirmed yet.
    pub fn has_suspect(&self) -> bool {
        self.steps.iter().any(|step| step.suspect_since_us.is_some())
    }

    /// Sensors that are excluded for a deviation, or had a new zero within the last minute.
    pub fn implausible(&self, time_us: u64) -> [bool; SENSORS_PER_SEGMENT] {
        let mut implausible = [false; SENSORS_PER_SEGMENT];
        for ((implausible, until_us), step) in implausible.iter_mut().zip(self.distrusted_until_us).zip(&self.steps) {
            let has_stepped = step.stepped_at_us.is_some_and(|at_us| time_us.saturating_sub(at_us) < NEW_ZERO_US);
            *implausible = time_us < until_us || has_stepped;
        }
        implausible
    }

    /// Detects sensors that step while θ moves by `motion` in `dt` (`None`: θ is unknown). Returns `true` if a sensor
    /// has a new zero.
    pub fn find_steps(
        &mut self,
        config: &BendErrorConfig,
        angles: [Option<S>; SENSORS_PER_SEGMENT],
        motion: Option<S>,
        dt: S,
        time_us: u64,
    ) -> bool {
        let motion = motion.filter(|_| dt < S::constant(STEP_GAP));
        let limit = S::from_q(config.step);
        self.steps
            .iter_mut()
            .zip(angles)
            .fold(false, |any, (step, angle)| any | step.update(angle, motion, limit, time_us))
    }

    /// Updates the running mean over the elapsed time, a minute at most.
    fn average_difference(&mut self, half: S, dt: S) {
        let longest = S::constant(DIFFERENCE_TIME);
        self.averaged = smaller(self.averaged + dt, longest);
        let share = if dt < self.averaged { dt / self.averaged } else { S::one() };
        self.difference += share * (half - self.difference);
    }

    /// Variance of the mean's offset in excess of the prior, estimated from the difference over a whole minute.
    pub fn offset_excess(&self, config: &BendErrorConfig) -> S {
        let slow = S::from_q(config.slow_difference);
        let beyond = magnitude(self.difference) - slow - slow - S::constant(IGNORED_DIFFERENCE);
        let is_complete = self.averaged >= S::constant(DIFFERENCE_TIME);
        if beyond < S::zero() || !is_complete {
            return S::zero();
        }
        S::from_q(config.slow_ratio) * scaled_square(beyond)
    }

    /// Compares each sensor with its twin and with `theta` of the IMUs, to which the estimated offset is added.
    pub fn check(
        &mut self,
        config: &BendErrorConfig,
        angles: [Option<S>; SENSORS_PER_SEGMENT],
        theta: S,
        time_us: u64,
    ) {
        if let [Some(a), Some(b)] = angles {
            let errors = [a - self.difference - theta, b + self.difference - theta].map(magnitude);
            let is_known = self.averaged > S::zero();
            let margin = if is_known { DIFFERENCE_MARGIN } else { UNKNOWN_DIFFERENCE_MARGIN };
            let twin = magnitude((a - b).half() - self.difference) - S::constant(margin);
            let is_apart = twin > S::zero() && is_beyond(twin, DIFFERENCE_DEPARTURE, S::from_q(config.difference));
            let worse = usize::from(errors[1] > errors[0]);
            let departs = is_beyond(errors[worse], DEPARTURE, S::from_q(config.sensor[worse]));
            if is_apart && departs {
                self.distrusted_until_us[worse] = time_us.saturating_add(DISTRUST_US);
            }
        }
        self.check_stuck(angles, theta, time_us);
    }

    /// Keeps sensors excluded while the IMUs, with which they would have to agree, are not read.
    pub fn hold_exclusions(&mut self, time_us: u64) {
        for until_us in &mut self.distrusted_until_us {
            if time_us < *until_us {
                *until_us = time_us.saturating_add(DISTRUST_US);
            }
        }
    }

    /// Detects sensors that do not move while the segment does.
    fn check_stuck(&mut self, angles: [Option<S>; SENSORS_PER_SEGMENT], theta: S, time_us: u64) {
        let is_complete = time_us.saturating_sub(self.range_from_us) >= STUCK_US;
        let moves = self.theta_range[1] - self.theta_range[0] > S::constant(MOVING);
        let sensors = self.sensor_ranges.iter_mut().zip(&mut self.distrusted_until_us).zip(angles);
        for ((range, until_us), angle) in sensors {
            let Some(angle) = angle else {
                // A sensor that was missing is not reported as stuck.
                *range = [-S::constant(STUCK), S::constant(STUCK)];
                continue;
            };
            if is_complete && moves && range[1] - range[0] < S::constant(STUCK) {
                *until_us = time_us.saturating_add(DISTRUST_US);
            }
            extend(range, angle, is_complete);
        }
        extend(&mut self.theta_range, theta, is_complete);
        if is_complete {
            self.range_from_us = time_us;
        }
    }
}

impl<S: Scalar> StepDetector<S> {
    /// Updates the detector with one sample; returns `true` if the sensor has a new zero.
    fn update(&mut self, angle: Option<S>, motion: Option<S>, least: S, time_us: u64) -> bool {
        let (Some(angle), Some(motion), Some(last)) = (angle, motion, self.expected) else {
            (self.expected, self.suspect_since_us) = (angle.filter(|_| motion.is_some()), None);
            return false;
        };
        let expected = last + motion;
        let limit = least + magnitude(motion);
        let limit = if self.suspect_since_us.is_some() { limit.half() } else { limit };
        let deviation = angle - expected;
        if magnitude(deviation) <= limit {
            (self.expected, self.suspect_since_us) = (Some(angle), None);
            return false;
        }
        let since_us = *self.suspect_since_us.get_or_insert(time_us);
        if time_us.saturating_sub(since_us) < STEP_CONFIRMATION_US {
            self.expected = Some(expected);
            return false;
        }
        self.zero -= deviation;
        (self.expected, self.suspect_since_us, self.stepped_at_us) = (Some(expected), None, Some(time_us));
        true
    }
}

/// Extends a range, or begins a new one.
fn extend<S: Scalar>(range: &mut [S; 2], value: S, is_new: bool) {
    let [lowest, highest] = *range;
    *range = if is_new {
        [value; 2]
    } else {
        [if value < lowest { value } else { lowest }, if value > highest { value } else { highest }]
    };
}

#[cfg(test)]
mod tests;
