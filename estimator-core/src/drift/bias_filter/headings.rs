//! Headings of one sample: those that are plausible, and those that are absent, from their neighbours.

use super::BiasFilter;
use super::bend_monitor::TrustedBend;
use super::heading_gate::{Expected, Verdict};
use super::state::{BIAS, RATE};
use crate::config::{ArmConfig, BendErrorConfig, SegmentConfig};
use crate::drift::{CorrectedArm, SensedArm};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, is_beyond, magnitude, smaller, variance_deg};

/// Doubt about a new zero that no bend sensor supports.
const UNSEEN_ZERO: Constant = variance_deg(15.0);
/// Doubt about a new zero: 2°, a quarter of the bend sensors' variance, and 0.02° a second of absence up to 400 s.
const NEW_ZERO: Constant = variance_deg(2.0);
const NEW_ZERO_CREEP: Constant = variance_deg(0.02 * 8.0);
const NEW_ZERO_RATE: Constant = variance_deg(0.025 * TIME_UNIT_S);
/// Doubt about an IMU that returned near its old zero.
const RETURNED: Constant = variance_deg(1.0);
/// An absent heading is drawn to its bend sensors with this time constant, time units: 20 s.
const ABSENT_TIME: Constant = Constant::new(20.0 / TIME_UNIT_S);
/// Bend sensors do not move by more in one sample: a step of a sensor, not of the arm.
const BEND_STEP: Constant = degrees(12.0);
/// An IMU whose bend sensors move by this much, and by four of their standard deviations, must change.
const FROZEN_MOTION: Constant = degrees(8.0);
const FROZEN_DEVIATIONS: Constant = Constant::new(4.0);

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// Headings that are read and plausible, from the base to the tip.
    pub(super) fn track_headings<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
        dt: F,
    ) {
        let mut below = Turns::ZERO;
        for (i, segment) in config.segments.iter().enumerate().take(N) {
            let motion = self.motion(i, bend, dt);
            let track = self.segments[i];
            let deviations = F::constant(FROZEN_MOTION);
            let frozen_motion = if is_beyond(deviations, FROZEN_DEVIATIONS, F::from_q(segment.bend_error.mean)) {
                deviations
            } else {
                deviations + deviations
            };
            let predicted = below + (track.theta + motion).to_turns();
            let expected = Expected {
                heading: predicted,
                motion,
                bias: self.state.bias[i],
                theta: track.theta,
                bend: bend[i].map(|bend| bend.theta),
                frozen_motion,
                above: self.deviation_above(i, config.segments, sensed, bend, predicted, dt),
            };
            let heading = &sensed.headings[i];
            let reading = heading.is_read().then(|| heading.unwrapped());
            let verdict = self.gates[i].take(reading, segment.imu_scale_error, &expected, sensed.time_us);
            self.apply(i, verdict, &expected, &segment.bend_error, sensed.time_us);
            below = self.segments[i].heading;
        }
    }

    /// Deviation of the heading above `i` from what the bend sensors predict from the heading `i`.
    fn deviation_above<S: Scalar>(
        &self,
        i: usize,
        segments: &[SegmentConfig<S>],
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
        predicted: Turns,
        dt: F,
    ) -> Option<Turns> {
        let above = i + 1;
        let (segment, track, gate) = (segments.get(above)?, self.segments.get(above)?, self.gates.get(above)?);
        let (heading, bias) = (sensed.headings.get(above)?, self.state.bias.get(above)?);
        let theta = track.theta + self.motion(above, bend, dt);
        (heading.is_read() && gate.is_known())
            .then(|| gate.deviation(heading.unwrapped(), segment.imu_scale_error, predicted + theta.to_turns() + *bias))
    }

    /// Motion of segment `i`'s bend sensors since the last sample.
    fn motion(&self, i: usize, bend: &[Option<TrustedBend<F>>; N], dt: F) -> F {
        let motion = bend[i].zip(self.segments[i].bend).map_or(F::zero(), |(now, last)| now.theta - last);
        let is_step = magnitude(motion) > F::constant(BEND_STEP) && dt < F::from_micros(1_000_000);
        if is_step { F::zero() } else { motion }
    }

    /// Uses a heading, and doubts its bias where it may have a new zero.
    fn apply(&mut self, i: usize, verdict: Verdict<F>, expected: &Expected<F>, error: &BendErrorConfig, time_us: u64) {
        let mut heading = expected.heading;
        let mut is_read = true;
        match verdict {
            Verdict::Accepted(read) => heading = read,
            Verdict::Returned(read, _) => {
                heading = read;
                self.state.doubt(i, BIAS, F::constant(RETURNED));
            }
            Verdict::Restarted(deviation, absence_us) => {
                self.segments[i].restarted_at_us = Some(time_us);
                self.state.bias[i] = self.state.bias[i] + deviation;
                let absence = F::from_micros(absence_us.min(400_000_000) as u32);
                let quarter = F::from_q(error.mean).half().half();
                let seen = F::constant(NEW_ZERO) + quarter + absence * F::constant(NEW_ZERO_CREEP);
                let doubt = if expected.bend.is_some() { seen } else { F::constant(UNSEEN_ZERO) };
                self.state.doubt(i, BIAS, doubt);
                self.state.doubt(i, RATE, F::constant(NEW_ZERO_RATE));
            }
            Verdict::Frozen(theta) => {
                let change = theta - expected.theta;
                heading = heading + (change - expected.motion).to_turns();
                is_read = false;
                if let Some(above) = self.segments.get_mut(i + 1) {
                    above.theta -= change - expected.motion;
                }
            }
            Verdict::Absent => is_read = false,
        }
        let track = &mut self.segments[i];
        (track.heading, track.is_heading_read) = (heading, is_read);
        if is_read {
            track.heading_read_at_us = time_us;
        }
    }

    /// Headings that were not read: from below by the segment's own bend sensors, and from above by those of the next.
    pub(super) fn fill_absent_headings<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        bend: &[Option<TrustedBend<F>>; N],
        dt: F,
    ) {
        let mut below = Turns::ZERO;
        for i in 0..N.min(config.segments.len()) {
            if !self.segments[i].is_heading_read {
                let share = smaller(dt / F::constant(ABSENT_TIME), F::one());
                let pull = bend[i].map_or(F::zero(), |bend| bend.theta - self.state.offset[i] - self.segments[i].theta);
                let own = self.segments[i].theta + self.motion(i, bend, dt) + share * pull;
                let mut heading = below + own.to_turns();
                if let Some(above) = self.segments.get(i + 1).filter(|above| above.is_heading_read) {
                    let next = above.theta + self.motion(i + 1, bend, dt);
                    let from_above = above.heading - next.to_turns();
                    let half: F = F::from_phase((from_above - heading).phase()).half();
                    heading = heading + half.to_turns();
                }
                self.segments[i].heading = heading;
            }
            below = self.segments[i].heading;
        }
    }

    /// θ of all segments, from their headings.
    pub(super) fn angles<S>(&mut self, segments: &[SegmentConfig<S>]) -> CorrectedArm<N> {
        let mut corrected = CorrectedArm::UNKNOWN;
        let (mut below, mut is_below_read) = (Turns::ZERO, true);
        for (i, track) in self.segments.iter_mut().enumerate().take(segments.len()) {
            let theta = Turns::from((track.heading - below).phase());
            track.theta = F::from_phase(theta.phase());
            corrected.fused[i] = Some(theta);
            corrected.imu[i] = (track.is_heading_read && is_below_read).then_some(theta);
            (below, is_below_read) = (track.heading, track.is_heading_read);
        }
        corrected
    }
}
