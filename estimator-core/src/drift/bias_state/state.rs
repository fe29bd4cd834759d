//! States, covariance and prediction.

use crate::config::BiasFilterConfig;
use crate::drift::bias_state::pending::{CovarianceUpdate, Row};
use crate::drift::bias_trace::{BiasOperation, BiasTrace};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};

/// Index of the bias β, rad, in a row of the covariance.
pub const BIAS: usize = 0;
/// Index of the rate v, rad per [`TIME_UNIT_S`](crate::TIME_UNIT_S).
pub const RATE: usize = 1;
/// Index of the offset o of the bend sensors, rad.
pub const OFFSET: usize = 2;

/// Largest variance of a bias, (29°)²: beyond it the state counts as unknown, and its variance is not increased.
const LARGEST: Constant = Constant::new(16.0);
/// Largest variance of a rate, (0.23 °/s)².
const LARGEST_RATE: Constant = Constant::new(4.0);
/// Longest prediction, µs: 384 s, six time units.
pub const LONGEST_PREDICTION_US: u64 = 384_000_000;
/// Largest growth of a bias's variance by its rate in one step of a prediction, (9°)²: the variance stays within fixed
/// point.
const LARGEST_GROWTH: Constant = Constant::new(1.6);
/// Time below which the growth is smaller in any case, time units.
const SHORT: Constant = Constant::new(0.25);

/// States and covariance, and a [trace](BiasTrace) of the operations on them.
#[derive(Debug, Clone, Copy)]
pub struct BiasState<S, const N: usize, T = ()> {
    /// β, from the tare's zero.
    pub bias: [Turns; N],
    /// v, rad per time unit.
    pub rate: [S; N],
    /// o, rad.
    pub offset: [S; N],
    /// P, [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times as large.
    pub(super) covariance: [[Row<S, N>; 3]; N],
    predicted_at_us: [u64; N],
    /// Part of the newest update that has not been applied to P yet.
    pub(super) pending: CovarianceUpdate<S, N>,
    pub(super) trace: T,
}

impl<S: Scalar, const N: usize> Default for BiasState<S, N> {
    fn default() -> Self {
        Self::new(S::zero())
    }
}

impl<S: Scalar, const N: usize> BiasState<S, N> {
    /// States of `zero` without variance.
    pub const fn new(zero: S) -> Self {
        Self::with_trace(zero, ())
    }
}

impl<S: Scalar, const N: usize, T: BiasTrace<S>> BiasState<S, N, T> {
    /// States of `zero` without variance, with a trace.
    pub const fn with_trace(zero: S, trace: T) -> Self {
        Self {
            bias: [Turns::ZERO; N],
            rate: [zero; N],
            offset: [zero; N],
            covariance: [[[[zero; 3]; N]; 3]; N],
            predicted_at_us: [0; N],
            pending: CovarianceUpdate::complete(zero),
            trace,
        }
    }

    /// Clears all states, but not the trace.
    pub fn clear(&mut self) {
        let trace = core::mem::take(&mut self.trace);
        *self = Self::with_trace(S::zero(), trace);
    }

    /// The trace.
    pub fn trace_mut(&mut self) -> &mut T {
        &mut self.trace
    }

    /// Initialises the covariance at the end of a tare. Each IMU's zero and each segment's straightness have
    /// independent errors; those of the segments add up along the arm.
    pub fn initialise(&mut self, config: &BiasFilterConfig, straightness: S, offsets: &[S; N], time_us: u64) {
        self.clear();
        self.predicted_at_us = [time_us; N];
        self.trace.record(BiasOperation::Start { straightness });
        for (i, ([biases, rates, own_offsets], offset)) in self.covariance.iter_mut().zip(offsets).enumerate() {
            for (j, [bias, ..]) in biases.iter_mut().enumerate() {
                *bias = S::from_int(1 + i.min(j) as i32) * straightness;
            }
            if let (Some([bias, ..]), Some([_, rate, _]), Some([.., own])) =
                (biases.get_mut(i), rates.get_mut(i), own_offsets.get_mut(i))
            {
                *bias += S::from_q(config.initial_bias);
                *rate = S::from_q(config.initial_rate);
                *own = *offset;
                let noise = [S::from_q(config.initial_bias), S::from_q(config.initial_rate), *offset];
                self.trace.record(BiasOperation::Noise { segment: i, noise });
            }
        }
    }

    /// Predicts IMU and segment `i` to `time_us`: x⁻ = A x, P⁻ = A P Aᵀ + Q. The process noise Q of the bias is an
    /// angle random walk, that of the rate a rate random walk; that of the offset keeps its variance at `offset`.
    pub fn predict(&mut self, i: usize, config: &BiasFilterConfig, offset: S, time_us: u64) {
        let Some(dt) = self.elapsed(i, time_us) else { return };
        self.integrate_rate(i, dt);
        let decay = self.decay_offset(i, config, dt);
        let is_known = self.diagonal(i, BIAS) < S::constant(LARGEST);
        self.propagate(i, dt, decay);
        let noise = [
            self.add_process_noise(i, BIAS, S::from_q(config.bias_noise) * dt, S::constant(LARGEST)),
            self.add_process_noise(i, RATE, S::from_q(config.rate_noise) * dt, S::constant(LARGEST_RATE)),
            self.add_process_noise(i, OFFSET, offset * (S::one() - decay * decay), S::constant(LARGEST)),
        ];
        let dt = if is_known { dt } else { S::zero() };
        self.trace.record(BiasOperation::Predict { segment: i, dt, decay, noise });
    }

    /// Predicts IMU and segment `i` while the arm rests: the bias follows the measured heading, not the rate, and its
    /// variance grows by `creep` per time unit alone.
    pub fn predict_at_rest(&mut self, i: usize, config: &BiasFilterConfig, creep: S, time_us: u64) {
        let Some(dt) = self.elapsed(i, time_us) else { return };
        self.integrate_rate(i, dt);
        let noise = [
            self.add_process_noise(i, BIAS, creep * dt, S::constant(LARGEST)),
            self.add_process_noise(i, RATE, S::from_q(config.rate_noise) * dt, S::constant(LARGEST_RATE)),
            S::zero(),
        ];
        self.trace.record(BiasOperation::Predict { segment: i, dt: S::zero(), decay: S::one(), noise });
    }

    /// Time since the last prediction, time units; `None` where no time has passed.
    fn elapsed(&mut self, i: usize, time_us: u64) -> Option<S> {
        let dt = self.elapsed_until(i, time_us)?;
        *self.predicted_at_us.get_mut(i)? = time_us;
        Some(dt)
    }

    fn elapsed_until(&self, i: usize, time_us: u64) -> Option<S> {
        let elapsed_us = time_us.checked_sub(*self.predicted_at_us.get(i)?).filter(|us| *us > 0)?;
        Some(S::from_micros(elapsed_us.min(LONGEST_PREDICTION_US) as u32))
    }

    /// β ← β + v `dt`.
    fn integrate_rate(&mut self, i: usize, dt: S) {
        if let (Some(bias), Some(rate)) = (self.bias.get_mut(i), self.rate.get(i)) {
            *bias = *bias + (*rate * dt).to_turns();
        }
    }

    /// Applies the offset's decay over `dt` to the state; returns the factor.
    fn decay_offset(&mut self, i: usize, config: &BiasFilterConfig, dt: S) -> S {
        let share = S::from_q(config.offset_rate) * dt;
        let decay = if share < S::one() { S::one() - share } else { S::zero() };
        if let Some(offset) = self.offset.get_mut(i) {
            *offset *= decay;
        }
        decay
    }

    /// P ← A P Aᵀ, where the Jacobian A of the model adds the rate times `dt` to the bias and multiplies the offset by
    /// `decay`. The variance of a bias that is unknown already is not increased by its rate.
    fn propagate(&mut self, i: usize, dt: S, decay: S) {
        let rate = self.diagonal(i, RATE);
        let (mut step, mut remainder) = (dt, dt);
        while step > S::constant(SHORT) && step * rate > S::constant(LARGEST_GROWTH) / step {
            step = step.half();
        }
        self.propagate_step(i, step, decay);
        remainder -= step;
        while remainder >= step && step > S::zero() && self.diagonal(i, BIAS) < S::constant(LARGEST) {
            self.propagate_step(i, step, S::one());
            remainder -= step;
        }
    }

    #[expect(clippy::needless_range_loop, reason = "each index is of two arrays")]
    fn propagate_step(&mut self, i: usize, dt: S, decay: S) {
        // With this and the loops' bounds the compiler omits the checks of the indices.
        if i >= N {
            return;
        }
        let p = &mut self.covariance;
        let dt = if p[i][BIAS][i][BIAS] < S::constant(LARGEST) { dt } else { S::zero() };
        for j in (0..N).filter(|j| *j != i) {
            for k in 0..3 {
                let [bias, rate, offset] = p[j][k][i];
                let (bias, offset) = (bias + dt * rate, offset * decay);
                p[j][k][i] = [bias, rate, offset];
                (p[i][BIAS][j][k], p[i][OFFSET][j][k]) = (bias, offset);
            }
        }
        let [bias, rate, offset] = p[i].map(|row| row[i]);
        let rows = [core::array::from_fn(|k| bias[k] + dt * rate[k]), rate, offset.map(|value| value * decay)];
        let [bias, rate, offset] = rows.map(|[bias, rate, offset]| [bias + dt * rate, rate, offset * decay]);
        p[i][BIAS][i] = [bias[BIAS], rate[BIAS], offset[BIAS]];
        p[i][RATE][i] = [rate[BIAS], rate[RATE], offset[RATE]];
        p[i][OFFSET][i] = offset;
    }

    /// Adds process noise to one state, up to a variance of `limit`; returns the added variance.
    fn add_process_noise(&mut self, i: usize, state: usize, variance: S, limit: S) -> S {
        match self.diagonal_mut(i, state) {
            Some(diagonal) if *diagonal < limit => {
                *diagonal += variance;
                variance
            }
            _ => S::zero(),
        }
    }

    fn diagonal(&self, i: usize, state: usize) -> S {
        let diagonal = || self.covariance.get(i)?.get(state)?.get(i)?.get(state).copied();
        diagonal().unwrap_or_else(S::zero)
    }

    fn diagonal_mut(&mut self, i: usize, state: usize) -> Option<&mut S> {
        self.covariance.get_mut(i)?.get_mut(state)?.get_mut(i)?.get_mut(state)
    }

    /// Inflates the variance of a state that has become uncertain.
    pub fn inflate_variance(&mut self, i: usize, state: usize, variance: S) {
        let limit = if state == RATE { LARGEST_RATE } else { LARGEST };
        let added = self.add_process_noise(i, state, variance, S::constant(limit));
        let mut noise = [S::zero(); 3];
        if let Some(noise) = noise.get_mut(state) {
            *noise = added;
        }
        self.trace.record(BiasOperation::Noise { segment: i, noise });
    }

    /// β_i, predicted to `time_us`, without a change of the states.
    pub fn bias_at(&self, i: usize, time_us: u64) -> Turns {
        let grown = self.elapsed_until(i, time_us).map_or(Turns::ZERO, |dt| (self.rate_of(i) * dt).to_turns());
        self.bias_of(i) + grown
    }

    /// β_i at its last prediction.
    pub fn bias_of(&self, i: usize) -> Turns {
        self.bias.get(i).copied().unwrap_or_default()
    }

    /// β_i − β_{i−1}, rad.
    pub fn angle_bias(&self, i: usize) -> S {
        let below = i.checked_sub(1).map_or(Turns::ZERO, |below| self.bias_of(below));
        S::from_phase((self.bias_of(i) - below).phase())
    }

    /// o_i, rad.
    pub fn angle_offset(&self, i: usize) -> S {
        self.offset.get(i).copied().unwrap_or_else(S::zero)
    }

    /// v_i, rad per time unit.
    pub fn rate_of(&self, i: usize) -> S {
        self.rate.get(i).copied().unwrap_or_else(S::zero)
    }

    /// Moves a bias without a change of its covariance.
    pub fn add_to_bias(&mut self, i: usize, angle: Turns) {
        if let Some(bias) = self.bias.get_mut(i) {
            *bias = *bias + angle;
        }
    }

    /// P of the states of two IMUs and segments: bias, rate and offset of `i` with those of `j`.
    pub fn covariance(&self, i: usize, j: usize) -> [[S; 3]; 3] {
        let block = |rows: &[Row<S, N>; 3]| rows.map(|row| row.get(j).copied().unwrap_or([S::zero(); 3]));
        self.covariance.get(i).map_or([[S::zero(); 3]; 3], block)
    }

    /// P of bias `i` with all biases.
    pub fn bias_covariances(&self, i: usize) -> impl Iterator<Item = S> {
        let row = self.covariance.get(i).map_or(&[][..], |[row, ..]| row);
        row.iter().map(|[bias, ..]| *bias)
    }
}
