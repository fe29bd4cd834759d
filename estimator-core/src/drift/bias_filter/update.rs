//! Updates of the bias filter: by bend sensors that have moved, one segment after the other, and by the drift of an arm
//! at rest.

use crate::config::{BendErrorConfig, BiasFilterConfig, SegmentConfig};
use crate::drift::bend_monitor::TrustedBend;
use crate::drift::bias_filter::filter::{BiasFilter, following};
use crate::drift::bias_filter::track::{MAX_RATIO, RestChange, SegmentTrack, bounded_ratio, since};
use crate::drift::bias_state::{BIAS, OFFSET};
use crate::drift::bias_trace::BiasTrace;
use crate::drift::correction::SensedArm;
use crate::drift::rest::RestWindow;
use crate::drift::share::Share;
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{degrees, is_beyond, larger, magnitude, scaled_square, smaller, variance_deg};
use crate::sensing::bend_sensors::BendAngles;

/// Travel of the IMUs and of the bend sensors since the last update, below which there is no new information.
const IMU_TRAVEL: Constant = degrees(1.0);
const BEND_TRAVEL: Constant = degrees(0.5);
/// Limit of the counted travel, rad.
const LONGEST_TRAVEL: Constant = Constant::new(16.0);
/// A segment that has not moved is updated once in this time, with the largest noise.
const STILL_US: u64 = 20_000_000;
/// Factor on the measurement noise, for errors that are correlated over more than ℓ and τ.
const LONG_ERRORS: i32 = 2;
/// Factor on the measurement noise of one sensor whose twin is missing, and the largest noise to which it applies.
const SINGLE: i32 = 5;
const LARGEST_SINGLE: Constant = Constant::new(6.0);
/// Innovation gate: one over six predicted standard deviations.
const GATE: Constant = Constant::new(1.0 / 6.0);
/// A segment's update is repeated in the next sample if a heading is missing that was read within this time.
const RETRY_US: u64 = 500_000;
/// Timeout of the innovation gate: the variances of the bias and the offset then grow by (3°)².
const GATE_TIMEOUT_US: u64 = 30_000_000;
const GATE_TIMEOUT_VARIANCE: Constant = variance_deg(3.0);
/// Variance added to the offset of a segment whose sensor has stepped.
const STEP_VARIANCE: Constant = variance_deg(1.0);
/// Factor on the bend sensors' variance in the tare: a single pose does not average the hysteresis.
const TARE_NOISE: Constant = Constant::new(4.0);
/// Creep of bend sensors that stay bent: error as a share of the mean bend angle over this time, time units.
const CREEP_ERROR: Constant = Constant::new(0.1);
const CREEP_TIME: Constant = Constant::new(0.5);
/// Growth of the offset's variance where one sensor of two is lost, in slow variances of their difference.
const LOST_SENSOR: Constant = Constant::new(1.5);
/// Process noise of the heading of a resting arm, 0.02 °/√s, and measurement noise of its change.
const REST_NOISE: Constant = variance_deg(0.02 * 8.0);
const REST_READING: Constant = variance_deg(0.064);
/// Creep of the arm itself after a motion: a random walk of its headings of this variance over the time of rest, so that it
/// slows down. The silicone creeps by up to 12 % of 40°, which is at most 1.8° over that time for any time constant.
const ARM_CREEP: Constant = variance_deg(1.4);
/// Windows of rest in a time unit: 12.8, rounded.
const WINDOWS: i32 = 13;
/// Gate of a heading change at rest: one over three predicted standard deviations.
const REST_GATE: Constant = Constant::new(1.0 / 3.0);

impl<F: FusedOps, const N: usize, T: BiasTrace<F>> BiasFilter<F, N, T> {
    /// Processes the next segment: checks its bend sensors against the IMUs and, where a sample does all work, predicts
    /// and updates its states. Returns `false` if it must be repeated in the next sample.
    pub(super) fn process_segment<S: Scalar>(
        &mut self,
        segments: &[SegmentConfig<S>],
        filter: &BiasFilterConfig,
        sensed: &SensedArm<S, N>,
    ) -> bool {
        let (i, time_us) = (self.next_segment, sensed.time_us);
        let (Some(segment), Some(bend)) = (segments.get(i), sensed.bend.get(i)) else { return false };
        let Some(are_headings_read) = self.are_headings_read(i, time_us) else { return false };
        self.next_segment = following(i, segments);
        self.check_bend(i, &segment.bend_error, bend, are_headings_read, time_us);
        if sensed.share == Share::Whole {
            self.inflate_offset_variance(i, &segment.bend_error);
            self.predict(i, filter, time_us);
            self.update_segment(i, &segment.bend_error, sensed, are_headings_read);
            self.state.finish_update();
        }
        true
    }

    /// Predicts the states of the segment that is updated next.
    pub(super) fn predict_next<S: Scalar>(
        &mut self,
        segments: &[SegmentConfig<S>],
        filter: &BiasFilterConfig,
        time_us: u64,
    ) {
        let i = self.next_update;
        let Some(segment) = segments.get(i) else { return };
        self.inflate_offset_variance(i, &segment.bend_error);
        self.predict(i, filter, time_us);
    }

    /// Updates the states by the next segment; the covariance follows in the next samples. If the update must wait, so
    /// does the next share of the work. A sample without an update evaluates the window of rest.
    pub(super) fn update_next<S: Scalar>(&mut self, segments: &[SegmentConfig<S>], sensed: &SensedArm<S, N>) {
        let i = self.next_update;
        let Some(segment) = segments.get(i) else { return };
        let Some(are_headings_read) = self.are_headings_read(i, sensed.time_us) else { return };
        self.next_update = following(i, segments);
        self.update_segment(i, &segment.bend_error, sensed, are_headings_read);
        if !self.state.is_updating() {
            self.state.begin_empty_update();
            self.evaluate_rest(sensed.time_us);
        }
    }

    /// Returns `true` if the headings of segment `i` and of the one below are read, and `None` if one is missing in
    /// this sample but was read recently: the segment is then repeated, lest a periodic gap hits each of its updates. The
    /// update by the tare does not wait: an IMU that has restarted since has another zero.
    fn are_headings_read(&self, i: usize, time_us: u64) -> Option<bool> {
        let track = self.segments.get(i)?;
        let below = i.checked_sub(1).and_then(|below| self.segments.get(below));
        let is_read = |track: &SegmentTrack<F>| track.is_heading_read;
        let is_recent = |track: &SegmentTrack<F>| time_us.saturating_sub(track.heading_read_at_us) < RETRY_US;
        let are_read = is_read(track) && below.is_none_or(is_read);
        let are_recent = || is_recent(track) && below.is_none_or(is_recent);
        (are_read || track.tare_bend.is_some() || !are_recent()).then_some(are_read)
    }

    /// Updates all states by the measurements of segment `i`.
    fn update_segment<S: Scalar>(
        &mut self,
        i: usize,
        error: &BendErrorConfig,
        sensed: &SensedArm<S, N>,
        are_headings_read: bool,
    ) {
        let biases = self.state.bias;
        self.use_tare(i, error);
        self.update_rate(i);
        let is_extrapolated = sensed.bend.get(i).is_none_or(|bend| bend.is_extrapolated);
        let bend = self.segments.get(i).and_then(|track| track.bend).filter(|_| !is_extrapolated);
        // One update at a time: that by the bend sensors can wait without loss.
        let is_free = sensed.share == Share::Whole || !self.state.is_updating();
        if let Some(bend) = bend.filter(|_| are_headings_read && is_free) {
            self.update(i, error, bend, sensed.time_us);
        }
        self.shift_headings(&biases);
    }

    /// Shifts the headings by the change of the biases in an update, so that the next readings are compared with
    /// corrected headings.
    fn shift_headings(&mut self, before: &[Turns; N]) {
        if self.state.bias == *before {
            return;
        }
        let (mut below, mut below_moved) = (Turns::ZERO, Turns::ZERO);
        for (track, (bias, before)) in self.segments.iter_mut().zip(self.state.bias.iter().zip(before)) {
            let moved = *before - *bias;
            track.heading = track.heading + moved;
            track.bias_steps = track.bias_steps + moved;
            track.theta = F::from_phase((track.heading - below).phase());
            let turned: F = F::from_phase((moved - below_moved).phase());
            track.counted_theta += turned;
            track.processed_theta += turned;
            (below, below_moved) = (track.heading, moved);
        }
    }

    /// Compares the bend sensors of segment `i` with the IMUs (steps, deviations, stuck sensors), and updates the
    /// detector of rest.
    fn check_bend<S: Scalar>(
        &mut self,
        i: usize,
        error: &BendErrorConfig,
        bend: &BendAngles<S>,
        are_headings_read: bool,
        time_us: u64,
    ) {
        let Some(track) = self.segments.get_mut(i) else { return };
        let angles = track.sensor_angles(bend);
        let dt = since(track.processed_at_us.replace(time_us).unwrap_or(time_us), time_us);
        track.mean_theta += smaller(dt / F::constant(CREEP_TIME), F::one()) * (track.theta - track.mean_theta);
        let motion = are_headings_read.then(|| track.theta - track.processed_theta);
        if track.monitor.find_steps(error, angles, motion, dt, time_us) {
            self.state.inflate_variance(i, OFFSET, F::constant(STEP_VARIANCE));
        }
        if are_headings_read {
            let expected = track.theta + self.state.angle_offset(i);
            track.monitor.check(error, angles, expected, time_us);
        } else {
            track.monitor.hold_exclusions(time_us);
        }
        track.monitor.compare(angles, dt, time_us);
        track.processed_theta = track.theta;
        // Without a sensor that has just stepped.
        track.bend = track.monitor.mean(angles, track.has_twins(), time_us);
        let heading = track.is_heading_read.then(|| track.heading + track.bias);
        self.rest.update(i, heading, track.bend.map(|bend| bend.theta.to_turns()), dt);
    }

    fn predict(&mut self, i: usize, filter: &BiasFilterConfig, time_us: u64) {
        let Some(track) = self.segments.get(i) else { return };
        if self.rest.is_resting() {
            let noise = F::constant(REST_NOISE) + F::from_int(WINDOWS) * self.creep;
            self.state.predict_at_rest(i, filter, noise, time_us);
        } else {
            self.state.predict(i, filter, track.offset_prior, time_us);
        }
    }

    /// Updates the states by the bend sensors' mean over the tare, as the reference pose is uncertain by its
    /// straightness.
    fn use_tare(&mut self, i: usize, error: &BendErrorConfig) {
        let Some(bend) = self.segments.get_mut(i).and_then(|track| track.tare_bend.take()) else { return };
        let nu = self.state.angle_offset(i) - bend - self.state.angle_bias(i);
        let innovation = self.state.innovation(i);
        self.state.begin_update(innovation, nu, F::constant(TARE_NOISE) * F::from_q(error.mean));
    }

    /// Inflates the variance of the offset if the two sensors disagree more than before, or one is lost.
    fn inflate_offset_variance(&mut self, i: usize, error: &BendErrorConfig) {
        let Some(track) = self.segments.get_mut(i) else { return };
        let is_single = track.bend.is_some_and(|bend| bend.is_single);
        if is_single && !track.is_single {
            track.lost_sensor_variance += F::constant(LOST_SENSOR) * scaled_square(F::from_q(error.slow_difference));
        }
        track.is_single = is_single;
        track.is_bend_missing = is_single || (track.bend.is_none() && track.sensors > 0);
        let prior = track.session_offset
            + track.lost_sensor_variance
            + track.monitor.offset_excess(error)
            + scaled_square(F::constant(CREEP_ERROR) * track.mean_theta);
        if prior > track.offset_prior {
            self.state.inflate_variance(i, OFFSET, prior - track.offset_prior);
            track.offset_prior = prior;
        }
    }

    /// Update of segment `i` by its bend sensors, if they have moved since the last one and pass the innovation gate.
    fn update(&mut self, i: usize, error: &BendErrorConfig, bend: TrustedBend<F>, time_us: u64) {
        let Some(track) = self.segments.get_mut(i) else { return };
        let single = if bend.is_single { F::from_q(error.difference) } else { F::zero() };
        let sigma = F::from_q(error.mean) + single;
        let nu = track.theta - bend.theta + self.state.angle_offset(i);
        let innovation = self.state.innovation(i);
        if is_beyond(nu, GATE, innovation.variance + sigma) {
            if track.is_gate_timed_out(time_us) {
                self.state.inflate_variance(i, BIAS, F::constant(GATE_TIMEOUT_VARIANCE));
                self.state.inflate_variance(i, OFFSET, F::constant(GATE_TIMEOUT_VARIANCE));
            }
            return;
        }
        track.gated_since_us = None;
        if self.rest.is_resting() {
            track.updated_at_us = time_us;
        }
        if let Some(ratio) = track.noise_ratio(error, bend.theta, time_us) {
            let r = F::from_int(LONG_ERRORS) * ratio * sigma;
            let r = if bend.is_single { F::from_int(SINGLE) * smaller(r, F::constant(LARGEST_SINGLE)) } else { r };
            self.state.begin_update(innovation, nu, r);
            (track.travelled, track.updated_at_us) = (F::zero(), time_us);
        }
    }

    /// Stores the changes over a window of rest for the updates of the segments.
    pub(super) fn evaluate_rest(&mut self, time_us: u64) {
        let Some(RestWindow { headings, bend, length_us, rested_us }) = self.rest.window(time_us) else { return };
        self.creep = F::constant(ARM_CREEP) * (since::<F>(0, length_us) / since(0, rested_us));
        for (track, (heading, bend)) in self.segments.iter_mut().zip(headings.into_iter().zip(bend)) {
            track.rest = heading.map(|heading| RestChange { heading, bend, length_us });
        }
    }

    /// Updates the rate by the change of heading `j` over a window of rest, per time: H = (v_j: 1). The change itself
    /// is added to the bias, so that the shape is held.
    fn update_rate(&mut self, j: usize) {
        if self.state.is_updating() {
            return;
        }
        let Some(change) = self.segments.get_mut(j).and_then(|track| track.rest.take()) else { return };
        let dt = since(0, change.length_us);
        let nu = change.heading - self.state.rate_of(j) * dt;
        let r = F::constant(REST_READING) + scaled_square(change.bend) + self.creep;
        let innovation = self.state.innovation_at_rest(j);
        if is_beyond(nu, REST_GATE, innovation.variance * dt * dt + r) {
            return;
        }
        self.state.begin_update(innovation, nu / dt, r / dt / dt);
        self.state.add_to_bias(j, nu.to_turns());
    }
}

impl<F: Scalar> SegmentTrack<F> {
    /// Registers an innovation beyond the gate; returns `true` if none has passed for [`GATE_TIMEOUT_US`].
    fn is_gate_timed_out(&mut self, time_us: u64) -> bool {
        let since_us = *self.gated_since_us.get_or_insert(time_us);
        let is_timed_out = time_us.saturating_sub(since_us) >= GATE_TIMEOUT_US;
        if is_timed_out {
            self.gated_since_us = None;
        }
        is_timed_out
    }

    /// Factor on the measurement noise of an update after a short travel or time; `None` if the motion is too small for
    /// an informative update, which then waits. Clipping the factor instead would count the same error several times.
    fn noise_ratio(&mut self, error: &BendErrorConfig, bend: F, time_us: u64) -> Option<F> {
        let travel = magnitude(self.theta - self.counted_theta);
        let bend_travel = magnitude(bend - self.counted_bend);
        if travel < F::constant(IMU_TRAVEL) || bend_travel < F::constant(BEND_TRAVEL) {
            let is_overdue = time_us.saturating_sub(self.updated_at_us) >= STILL_US;
            return is_overdue.then(|| F::from_int(MAX_RATIO));
        }
        (self.counted_theta, self.counted_bend) = (self.theta, bend);
        self.travelled = smaller(self.travelled + travel, F::constant(LONGEST_TRAVEL));
        let by_travel = bounded_ratio(F::from_q(error.travel), self.travelled);
        let by_time = bounded_ratio(F::from_q(error.correlation_time).half(), since(self.updated_at_us, time_us));
        let ratio = larger(larger(by_travel, by_time), F::one());
        (ratio < F::from_int(MAX_RATIO)).then_some(ratio)
    }
}
