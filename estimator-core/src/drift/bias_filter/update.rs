//! Updates of the bias filter: by the bend sensors of one segment in its turn, and by a whole arm at rest.

use super::BiasFilter;
use super::bend_monitor::TrustedBend;
use super::rest::RestWindow;
use super::state::{BIAS, OFFSET};
use crate::config::{ArmConfig, BendErrorConfig, BiasFilterConfig};
use crate::drift::SensedArm;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{degrees, is_beyond, larger, magnitude, scaled_square, variance_deg};

/// Travel of the IMUs and of the bend sensors since the last update, below which there is no new information.
const IMU_TRAVEL: Constant = degrees(1.0);
const BEND_TRAVEL: Constant = degrees(0.5);
/// Factor on the measurement noise: errors that last longer than ℓ and τ.
const LONG_ERRORS: i32 = 2;
/// Largest factor on the measurement noise: the update is worth nothing beyond it.
const MAX_RATIO: i32 = 15;
/// Innovation gate in predicted standard deviations.
const GATE: Constant = Constant::new(6.0);
/// After so long beyond the gate the bias and the offset become doubtful, by 3°.
const GATE_TIMEOUT_US: u64 = 30_000_000;
const GATED: Constant = variance_deg(3.0);
/// Growth of the offset's variance where one sensor of two is lost, in slow variances of their difference.
const LOST_SENSOR: Constant = Constant::new(1.5);
/// Doubt about the heading of a resting arm, 0.02 °/√s, and about the rate learned at rest.
const REST_CREEP: Constant = variance_deg(0.02 * 8.0);
const REST_READING: Constant = variance_deg(0.064);
/// Gate of a rest's heading change, in predicted standard deviations.
const REST_GATE: Constant = Constant::new(3.0);

impl<F: Scalar, const N: usize> BiasFilter<F, N> {
    /// Predicts the IMU and the segment whose turn it is, and updates the filter by its bend sensors.
    pub(super) fn update_turn<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        filter: &BiasFilterConfig,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
    ) {
        let i = self.turn;
        self.turn = if i + 1 < config.segments.len().min(N) { i + 1 } else { 0 };
        let Some(segment) = config.segments.get(i) else { return };
        self.grow_offset(i, filter, &segment.bend_error, bend[i].as_ref());
        if self.rest.is_resting() {
            self.state.predict_at_rest(i, filter, F::constant(REST_CREEP), sensed.time_us);
        } else {
            self.state.predict(i, filter, self.segments[i].offset_prior, sensed.time_us);
        }
        let is_below_read = i.checked_sub(1).is_none_or(|below| self.segments[below].is_heading_read);
        let is_trusted = self.segments[i].is_heading_read && is_below_read && !sensed.bend[i].is_extrapolated;
        if let Some(bend) = bend[i].filter(|_| is_trusted) {
            self.update(i, &segment.bend_error, bend, sensed.time_us);
        }
    }

    /// Widens the prior of the offset where the two sensors disagree more than before, or one is lost.
    fn grow_offset(
        &mut self,
        i: usize,
        filter: &BiasFilterConfig,
        error: &BendErrorConfig,
        bend: Option<&TrustedBend<F>>,
    ) {
        let track = &mut self.segments[i];
        let is_single = bend.is_some_and(|bend| bend.is_single);
        if is_single && !track.is_single {
            track.lost += F::constant(LOST_SENSOR) * scaled_square(F::from_q(error.slow_difference));
        }
        track.is_single = is_single;
        let prior = F::from_q(filter.offset) + track.lost + self.monitors[i].offset_excess(error, false);
        if prior > track.offset_prior {
            self.state.doubt(i, OFFSET, prior - track.offset_prior);
            track.offset_prior = prior;
        }
    }

    /// Update of segment `i` by its bend sensors, if they have moved since the last one and pass the innovation gate.
    fn update(&mut self, i: usize, error: &BendErrorConfig, bend: TrustedBend<F>, time_us: u64) {
        let track = self.segments[i];
        let single = if bend.is_single { F::from_q(error.difference) } else { F::zero() };
        let sigma = F::from_q(error.mean) + single;
        let nu = track.theta - bend.theta + self.state.offset[i];
        let innovation = self.state.innovation(i);
        if is_beyond(nu, GATE, innovation.variance + sigma) {
            self.reject(i, time_us);
            return;
        }
        self.segments[i].gated_since_us = None;
        let travel = magnitude(track.theta - track.updated_theta);
        let bend_travel = magnitude(bend.theta - track.updated_bend);
        if travel < F::constant(IMU_TRAVEL) || bend_travel < F::constant(BEND_TRAVEL) {
            return;
        }
        let elapsed_us = time_us.saturating_sub(track.updated_at_us).min(u64::from(u32::MAX)) as u32;
        let by_travel = bounded_ratio(F::from_q(error.travel), travel);
        let by_time = bounded_ratio(F::from_q(error.correlation_time).half(), F::from_micros(elapsed_us));
        let ratio = larger(larger(by_travel, by_time), F::one());
        let ratio = if bend.is_single { F::from_int(MAX_RATIO) } else { ratio };
        self.state.update(&innovation, nu, F::from_int(LONG_ERRORS) * ratio * sigma);
        let track = &mut self.segments[i];
        (track.updated_theta, track.updated_bend, track.updated_at_us) = (track.theta, bend.theta, time_us);
    }

    /// An innovation beyond the gate: when none passes for long, the bias and the offset are doubted.
    fn reject(&mut self, i: usize, time_us: u64) {
        let since_us = *self.segments[i].gated_since_us.get_or_insert(time_us);
        if time_us.saturating_sub(since_us) >= GATE_TIMEOUT_US {
            self.state.doubt(i, BIAS, F::constant(GATED));
            self.state.doubt(i, OFFSET, F::constant(GATED));
            self.segments[i].gated_since_us = None;
        }
    }

    /// Learns the rates from an arm at rest, and holds its shape.
    pub(super) fn follow_rest<S: Scalar>(
        &mut self,
        config: &ArmConfig<S>,
        sensed: &SensedArm<S, N>,
        bend: &[Option<TrustedBend<F>>; N],
        dt: F,
    ) {
        let mut headings = [None; N];
        let mut angles = [None; N];
        for (i, _) in config.segments.iter().enumerate().take(N) {
            let track = &self.segments[i];
            headings[i] = track.is_heading_read.then(|| track.heading + self.state.bias[i]);
            angles[i] = bend[i].map(|bend| bend.theta.to_turns());
        }
        let Some(window) = self.rest.take(&headings, &angles, dt, sensed.time_us) else { return };
        for j in 0..config.segments.len().min(N) {
            if let Some(change) = window.headings[j] {
                self.learn_rate(j, change, &window);
            }
        }
    }

    /// The change of heading `j` over a window of rest, H = (v_j: dt).
    fn learn_rate(&mut self, j: usize, change: F, window: &RestWindow<F, N>) {
        let dt = F::from_micros(window.length_us.min(u64::from(u32::MAX)) as u32);
        let drift = self.state.rate[j] * dt;
        let nu = change - drift;
        let r = F::constant(REST_READING) + scaled_square(window.bend[j]);
        let innovation = self.state.innovation_at_rest(j, dt);
        if is_beyond(nu, REST_GATE, innovation.variance + r) {
            return;
        }
        self.state.update(&innovation, nu, r);
        // The shape stays: what the heading has changed by was its bias.
        self.state.bias[j] = self.state.bias[j] + nu.to_turns();
    }
}

/// `a / b`, at most [`MAX_RATIO`].
fn bounded_ratio<F: Scalar>(a: F, b: F) -> F {
    let largest = F::from_int(MAX_RATIO);
    if b * largest > a { a / b } else { largest }
}
