//! Headings of one sample: plausible readings, and absent headings from the bend sensors.

use crate::config::{ArmConfig, BendErrorConfig};
use crate::drift::bias_filter::filter::BiasFilter;
use crate::drift::bias_filter::track::SegmentTrack;
use crate::drift::bias_state::{BIAS, BiasState, RATE};
use crate::drift::bias_trace::BiasTrace;
use crate::drift::correction::SensedArm;
use crate::drift::heading_gate::{HeadingPrediction, Verdict};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, smaller, variance_deg};
use crate::sensing::heading::SegmentHeading;

/// Variance of a new zero: 2°, a quarter of the bend sensors' variance, and 0.02° a second of absence up to 400 s.
const NEW_ZERO: Constant = variance_deg(2.0);
const NEW_ZERO_CREEP: Constant = variance_deg(0.02 * 8.0);
const NEW_ZERO_RATE: Constant = variance_deg(0.025 * TIME_UNIT_S);
/// Variance of a new zero without bend sensors.
const UNSEEN_ZERO: Constant = variance_deg(15.0);
/// Variance added for an IMU that returned near its old zero.
const RETURNED: Constant = variance_deg(1.0);
/// Time constant with which an absent heading follows its bend sensors, s.
pub const ABSENT_TIME_S: f64 = 20.0;
/// [`ABSENT_TIME_S`] in time units.
const ABSENT_TIME: Constant = Constant::new(ABSENT_TIME_S / TIME_UNIT_S);
/// An IMU is frozen if it does not change while the bend sensors move by this much, and by four of their standard
/// deviations.
const FROZEN_MOTION: Constant = degrees(8.0);
const FROZEN_VARIANCE: Constant = variance_deg(8.0 / 4.0);

impl<F: Scalar, const N: usize, T: BiasTrace<F>> BiasFilter<F, N, T> {
    /// Updates the headings with this sample's plausible readings, from the base to the tip.
    pub(super) fn track_headings<S: Scalar>(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>) {
        let (mut below, mut excess) = (Turns::ZERO, F::zero());
        let mut readings = config.segments.iter().zip(&sensed.headings).enumerate();
        let mut tracks = self.segments.as_mut_slice();
        while let (Some((i, (segment, heading))), Some((track, next))) = (readings.next(), tracks.split_first_mut()) {
            track.theta -= excess;
            let bias = self.state.bias_at(i, sensed.time_us);
            let expected = track.expected(below, bias, &segment.bend_error);
            let reading = heading.is_read().then(|| heading.unwrapped());
            // Evaluated only where a reading deviates.
            let above = || {
                let (next, (segment, heading)) = (next.first()?, readings.clone().next()?.1);
                let bias = self.state.bias_at(i + 1, sensed.time_us);
                next.deviation_from(expected.heading, bias, heading, segment.imu_scale_error)
            };
            track.has_reading = reading.is_some();
            let verdict = track.gate.check(reading, segment.imu_scale_error, &expected, above, sensed.time_us);
            inflate_bias_variance(&mut self.state, i, verdict, &expected, &segment.bend_error);
            excess = track.apply(verdict, &expected, sensed.time_us);
            below = track.heading;
            tracks = next;
        }
    }

    /// Estimates the headings that were not read: from below by the segment's own bend sensors, and from above by those
    /// of the next segment. A path without a bend sensor counts only where neither has one; the path from above is drawn
    /// to its bend sensors only where it is the only one.
    pub(super) fn fill_absent_headings(&mut self, count: usize, dt: F, time_us: u64) {
        let share = smaller(dt / F::constant(ABSENT_TIME), F::one());
        let (mut below, mut is_below_measured) = (Turns::ZERO, true);
        let mut offsets = self.state.offset.as_slice();
        let mut tracks = self.segments.get_mut(..count).unwrap_or_default();
        while let (Some((track, above)), Some((offset, offsets_above))) =
            (tracks.split_first_mut(), offsets.split_first())
        {
            let is_by_own = is_below_measured && track.bend.is_some();
            let mut is_measured = track.is_heading_read || is_by_own;
            if !track.is_heading_read {
                track.heading = below + track.carried(*offset, share).to_turns();
                let read_above = above.first().zip(offsets_above.first()).filter(|(above, _)| above.is_heading_read);
                if let Some((above, offset)) = read_above {
                    let share = if is_by_own { F::zero() } else { share };
                    let from_above = above.heading - above.carried(*offset, share).to_turns();
                    let shift = from_above - track.heading;
                    track.heading = match (is_by_own, above.bend) {
                        (true, None) => track.heading,
                        (false, Some(_)) => from_above,
                        _ => track.heading + F::from_phase(shift.phase()).half().to_turns(),
                    };
                    is_measured |= above.bend.is_some();
                }
            }
            if is_measured {
                track.heading_measured_at_us = time_us;
            }
            if track.bend.is_some() || is_below_measured && is_measured {
                track.theta_measured_at_us = time_us;
            }
            (below, is_below_measured) = (track.heading, is_measured);
            (tracks, offsets) = (above, offsets_above);
        }
    }
}

impl<F: Scalar> SegmentTrack<F> {
    /// θ of the last sample, carried on by the motion of the bend sensors and drawn to their angle by a `share` of the way.
    fn carried(&self, offset: F, share: F) -> F {
        let moved = self.theta + self.motion;
        self.bend.map_or(moved, |bend| moved + share * (bend.theta - offset - moved))
    }

    /// Deviation of the reading from the heading predicted from the one `below`; `None` where it was not read.
    fn deviation_from(&self, below: Turns, bias: Turns, heading: &SegmentHeading, scale_error: i32) -> Option<Turns> {
        let predicted = below + (self.theta + self.motion).to_turns() + bias;
        (heading.is_read() && self.gate.is_known())
            .then(|| self.gate.deviation(heading.unwrapped(), scale_error, predicted))
    }

    /// Prediction of the heading by the bend sensors and the heading `below`.
    fn expected(&self, below: Turns, bias: Turns, error: &BendErrorConfig) -> HeadingPrediction<F> {
        let motion = F::constant(FROZEN_MOTION);
        let is_beyond_errors = F::from_q(error.mean) < F::constant(FROZEN_VARIANCE);
        HeadingPrediction {
            heading: below + (self.theta + self.motion).to_turns(),
            motion: self.motion,
            bias,
            theta: self.theta,
            bend: self.bend.map(|bend| bend.theta),
            frozen_motion: if is_beyond_errors { motion } else { motion + motion },
        }
    }

    /// Applies the verdict on a heading; returns by how much a correction of it makes θ of the next segment too large,
    /// rad.
    fn apply(&mut self, verdict: Verdict<F>, expected: &HeadingPrediction<F>, time_us: u64) -> F {
        let mut excess = F::zero();
        self.bias = expected.bias;
        (self.heading, self.is_heading_read) = match verdict {
            Verdict::Accepted(heading) => (heading, true),
            Verdict::Returned(heading) => {
                self.restarted_at_us = Some(time_us);
                (heading, true)
            }
            Verdict::Restarted(deviation, _) => {
                self.bias = self.bias + deviation;
                self.restarted_at_us = Some(time_us);
                (expected.heading, true)
            }
            Verdict::Frozen(theta) => {
                excess = theta - expected.theta - expected.motion;
                self.theta = theta - expected.motion;
                (expected.heading + excess.to_turns(), false)
            }
            Verdict::Absent => (expected.heading, false),
        };
        if self.is_heading_read {
            self.heading_read_at_us = time_us;
        }
        excess
    }
}

/// Inflates the variance of the bias of a heading that may have a new zero.
fn inflate_bias_variance<F: Scalar, const N: usize, T: BiasTrace<F>>(
    state: &mut BiasState<F, N, T>,
    i: usize,
    verdict: Verdict<F>,
    expected: &HeadingPrediction<F>,
    error: &BendErrorConfig,
) {
    match verdict {
        Verdict::Returned(_) => state.inflate_variance(i, BIAS, F::constant(RETURNED)),
        Verdict::Restarted(deviation, absence_us) => {
            state.add_to_bias(i, deviation);
            let absence = F::from_micros(absence_us.min(400_000_000) as u32);
            let quarter = F::from_q(error.mean).half().half();
            let seen = F::constant(NEW_ZERO) + quarter + absence * F::constant(NEW_ZERO_CREEP);
            let variance = if expected.bend.is_some() { seen } else { F::constant(UNSEEN_ZERO) };
            state.inflate_variance(i, BIAS, variance);
            state.inflate_variance(i, RATE, F::constant(NEW_ZERO_RATE));
        }
        Verdict::Accepted(_) | Verdict::Absent | Verdict::Frozen(_) => {}
    }
}
