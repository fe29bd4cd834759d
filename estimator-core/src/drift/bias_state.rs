//! The bias filter's model: a Kalman filter over all IMUs and segments at once.
//!
//! States: of each IMU j its heading's bias β_j and the bias's rate v_j, of each segment i the offset o_i of its bend
//! sensors in this session.
//!
//! | | |
//! |---|---|
//! | model | β̇ = v + white noise, v̇ = white noise, o a Gauss–Markov process |
//! | measurement | z_i = θ_imu,i − θ_bend,i = β_i − β_{i−1} − o_i + noise |
//!
//! The covariance is that of all states, because an error of one heading is in two bend angles with opposite signs: what is
//! wrong with one angle is undone by the next, and hardly moves the tip.
//!
//! Each IMU and its segment are predicted when it is their turn, one in a sample, so that a sample costs a share of the whole.

use crate::config::BiasFilterConfig;
use crate::drift::bias_trace::{BiasMeasurement, BiasOperation, BiasTrace};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};

/// Index of the bias β, rad, in a row of the covariance.
pub const BIAS: usize = 0;
/// Index of the rate v, rad per [`TIME_UNIT_S`](crate::TIME_UNIT_S).
pub const RATE: usize = 1;
/// Index of the offset o of the bend sensors, rad.
pub const OFFSET: usize = 2;

/// Covariances of one state with all others: bias, rate and offset of each IMU and segment.
pub type Row<S, const N: usize> = [[S; 3]; N];

/// Largest variance of a bias, 29°: beyond it the state is unknown, and its variance stays.
const LARGEST: Constant = Constant::new(16.0);
/// Largest variance of a rate, 0.23 °/s.
const LARGEST_RATE: Constant = Constant::new(4.0);
/// Longest prediction, time units: 384 s.
const LONGEST: Constant = Constant::new(6.0);
/// Two variances below this add up in fixed point.
const HALF_OF_RANGE: Constant = Constant::new(15.5);
/// Growth of a bias's variance by its rate in one step of a prediction, 9°: the variance stays within fixed point.
const LARGEST_GROWTH: Constant = Constant::new(1.6);
/// A prediction over a time unit's quarter grows by less.
const SHORT: Constant = Constant::new(0.25);
/// Smallest variance, 0.004° or 0.004° per time unit: rounding must not bring one to zero.
const SMALLEST: Constant = Constant::new(3e-7);

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
    covariance: [[Row<S, N>; 3]; N],
    predicted_at_us: [u64; N],
    trace: T,
}

/// Innovation of a scalar measurement: P⁻Hᵀ, and the variance S = H P⁻ Hᵀ without the measurement noise.
pub struct Innovation<S, const N: usize> {
    cross: Row<S, N>,
    /// H P⁻ Hᵀ; in fixed point no more than it holds.
    pub variance: S,
    /// An eighth of it, which fits in any case.
    eighth: S,
    measurement: BiasMeasurement,
}

fn eighth<S: Scalar>(value: S) -> S {
    value.half().half().half()
}

impl<S: Scalar, const N: usize> Default for BiasState<S, N> {
    fn default() -> Self {
        Self::new(S::zero())
    }
}

impl<S: Scalar, const N: usize> BiasState<S, N> {
    /// Nothing known: states of `zero` without variance.
    pub const fn new(zero: S) -> Self {
        Self::with_trace(zero, ())
    }
}

impl<S: Scalar, const N: usize, T: BiasTrace<S>> BiasState<S, N, T> {
    /// As [`Self::new`], with a trace.
    pub const fn with_trace(zero: S, trace: T) -> Self {
        Self {
            bias: [Turns::ZERO; N],
            rate: [zero; N],
            offset: [zero; N],
            covariance: [[[[zero; 3]; N]; 3]; N],
            predicted_at_us: [0; N],
            trace,
        }
    }

    /// Forgets all states, but not the trace.
    pub fn clear(&mut self) {
        let trace = core::mem::take(&mut self.trace);
        *self = Self::with_trace(S::zero(), trace);
    }

    /// The trace.
    pub fn trace_mut(&mut self) -> &mut T {
        &mut self.trace
    }

    /// The prior at the end of a tare. Each IMU's zero and each segment's straightness have an error of their own; those of
    /// the segments add up along the arm.
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

    /// Predicts IMU and segment `i` to `time_us`: x⁻ = A x, P⁻ = A P Aᵀ + Q. The process noise of the offset keeps its
    /// variance at `offset`.
    pub fn predict(&mut self, i: usize, config: &BiasFilterConfig, offset: S, time_us: u64) {
        let Some(dt) = self.elapsed(i, time_us) else { return };
        self.follow_rate(i, dt);
        let decay = self.decay_offset(i, config, dt);
        let is_known = self.diagonal(i, BIAS) < S::constant(LARGEST);
        self.propagate(i, dt, decay);
        let noise = [
            self.grow(i, BIAS, S::from_q(config.bias_noise) * dt, S::constant(LARGEST)),
            self.grow(i, RATE, S::from_q(config.rate_noise) * dt, S::constant(LARGEST_RATE)),
            self.grow(i, OFFSET, offset * (S::one() - decay * decay), S::constant(LARGEST)),
        ];
        let dt = if is_known { dt } else { S::zero() };
        self.trace.record(BiasOperation::Predict { segment: i, dt, decay, noise });
    }

    /// Predicts IMU and segment `i` while the arm rests: the bias follows the measured heading, not the rate, and its
    /// variance grows by `creep` per time unit alone.
    pub fn predict_at_rest(&mut self, i: usize, config: &BiasFilterConfig, creep: S, time_us: u64) {
        let Some(dt) = self.elapsed(i, time_us) else { return };
        self.follow_rate(i, dt);
        let noise = [
            self.grow(i, BIAS, creep * dt, S::constant(LARGEST)),
            self.grow(i, RATE, S::from_q(config.rate_noise) * dt, S::constant(LARGEST_RATE)),
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
        let (dt, longest) = (S::from_micros(elapsed_us.min(u64::from(u32::MAX)) as u32), S::constant(LONGEST));
        Some(if dt < longest { dt } else { longest })
    }

    /// β ← β + v `dt`.
    fn follow_rate(&mut self, i: usize, dt: S) {
        if let (Some(bias), Some(rate)) = (self.bias.get_mut(i), self.rate.get(i)) {
            *bias = *bias + (*rate * dt).to_turns();
        }
    }

    /// The offset's factor over `dt`, applied to the state.
    fn decay_offset(&mut self, i: usize, config: &BiasFilterConfig, dt: S) -> S {
        let share = S::from_q(config.offset_rate) * dt;
        let decay = if share < S::one() { S::one() - share } else { S::zero() };
        if let Some(offset) = self.offset.get_mut(i) {
            *offset *= decay;
        }
        decay
    }

    /// P ← A P Aᵀ, where A adds the rate times `dt` to the bias and multiplies the offset by `decay`. A bias that is unknown
    /// already learns nothing more from its rate.
    fn propagate(&mut self, i: usize, dt: S, decay: S) {
        let rate = self.diagonal(i, RATE);
        let (mut step, mut rest) = (dt, dt);
        while step > S::constant(SHORT) && step * rate > S::constant(LARGEST_GROWTH) / step {
            step = step.half();
        }
        self.propagate_step(i, step, decay);
        rest -= step;
        while rest >= step && step > S::zero() && self.diagonal(i, BIAS) < S::constant(LARGEST) {
            self.propagate_step(i, step, S::one());
            rest -= step;
        }
    }

    fn propagate_step(&mut self, i: usize, dt: S, decay: S) {
        let Some([bias, rate, offset]) = self.covariance.get_mut(i) else { return };
        let is_known = bias.get(i).is_some_and(|[bias, ..]| *bias < S::constant(LARGEST));
        let dt = if is_known { dt } else { S::zero() };
        for ((bias, rate), offset) in bias.iter_mut().zip(rate.iter()).zip(offset.iter_mut()) {
            for ((bias, rate), offset) in bias.iter_mut().zip(rate).zip(offset) {
                *bias += dt * *rate;
                *offset *= decay;
            }
        }
        for row in [bias, rate, offset] {
            if let Some([bias, rate, offset]) = row.get_mut(i) {
                *bias += dt * *rate;
                *offset *= decay;
            }
        }
        self.mirror(i);
    }

    /// Copies the rows of `i` to its columns.
    fn mirror(&mut self, i: usize) {
        let Some([mut bias, mut rate, offset]) = self.covariance.get(i).copied() else { return };
        // Its own block's upper half is that of the lower one.
        if let (
            Some([_, bias_rate, bias_offset]),
            Some([rate_bias, _, rate_offset]),
            Some([offset_bias, offset_rate, _]),
        ) = (bias.get_mut(i), rate.get_mut(i), offset.get(i))
        {
            (*bias_rate, *bias_offset, *rate_offset) = (*rate_bias, *offset_bias, *offset_rate);
        }
        for (j, rows) in self.covariance.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let (Some(bias), Some(rate), Some(offset)) = (bias.get(j), rate.get(j), offset.get(j)) else { return };
            for (row, ((bias, rate), offset)) in rows.iter_mut().zip(bias.iter().zip(rate).zip(offset)) {
                if let Some(own) = row.get_mut(i) {
                    *own = [*bias, *rate, *offset];
                }
            }
        }
        if let Some(rows) = self.covariance.get_mut(i) {
            *rows = [bias, rate, offset];
        }
    }

    /// Adds process noise to one state, up to a variance of `limit`; gives what it has added.
    fn grow(&mut self, i: usize, state: usize, variance: S, limit: S) -> S {
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

    /// Adds to the variance of a state that has become doubtful.
    pub fn doubt(&mut self, i: usize, state: usize, variance: S) {
        let limit = if state == RATE { LARGEST_RATE } else { LARGEST };
        let added = self.grow(i, state, variance, S::constant(limit));
        let mut noise = [S::zero(); 3];
        if let Some(noise) = noise.get_mut(state) {
            *noise = added;
        }
        self.trace.record(BiasOperation::Noise { segment: i, noise });
    }

    /// β_i, predicted to `time_us`; the states stay.
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

    /// P of two biases.
    pub fn bias_covariance(&self, i: usize, j: usize) -> S {
        let covariance = || self.covariance.get(i)?.first()?.get(j)?.first().copied();
        covariance().unwrap_or_else(S::zero)
    }

    /// Innovation of segment `i`'s bend sensors against its IMUs, H = (β_i: 1, β_{i−1}: −1, o_i: −1).
    pub fn innovation(&self, i: usize) -> Innovation<S, N> {
        let below = i.checked_sub(1);
        let mut cross = [[S::zero(); 3]; N];
        if let Some([bias, _, offset]) = self.covariance.get(i) {
            for ((cross, bias), offset) in cross.iter_mut().zip(bias).zip(offset) {
                for ((cross, bias), offset) in cross.iter_mut().zip(bias).zip(offset) {
                    *cross = *bias - *offset;
                }
            }
        }
        if let Some([bias, ..]) = below.and_then(|below| self.covariance.get(below)) {
            for (cross, bias) in cross.iter_mut().zip(bias) {
                for (cross, bias) in cross.iter_mut().zip(bias) {
                    *cross -= *bias;
                }
            }
        }
        let [bias, _, offset] = cross.get(i).copied().unwrap_or([S::zero(); 3]);
        let of_below = below.and_then(|below| cross.get(below)).map_or(S::zero(), |[bias, ..]| *bias);
        let eighth = eighth(bias) - eighth(offset) - eighth(of_below);
        Innovation {
            cross,
            variance: bias - offset - of_below,
            eighth,
            measurement: BiasMeasurement::BendAngle { segment: i },
        }
    }

    /// Innovation of heading `j`'s rate while the arm rests, H = (v_j: 1).
    pub fn innovation_at_rest(&self, j: usize) -> Innovation<S, N> {
        let cross = self.covariance.get(j).map_or([[S::zero(); 3]; N], |[_, rate, _]| *rate);
        let variance = cross.get(j).map_or(S::zero(), |[_, rate, _]| *rate);
        Innovation { cross, variance, eighth: eighth(variance), measurement: BiasMeasurement::Rate { segment: j } }
    }

    /// K = P⁻Hᵀ/S, x = x⁻ + K ν, P = P⁻ − K (P⁻Hᵀ)ᵀ, for the innovation ν and measurement noise R.
    pub fn update(&mut self, innovation: &Innovation<S, N>, nu: S, r: S) {
        let Innovation { cross, variance, eighth: variance_eighth, measurement } = innovation;
        self.trace.record(BiasOperation::Update { measurement: *measurement, nu, r });
        let mut gain = *cross;
        let half = S::constant(HALF_OF_RANGE);
        if *variance < half && r < half {
            let s = *variance + r;
            for value in gain.iter_mut().flatten() {
                *value = *value / s;
            }
        } else {
            let s = *variance_eighth + eighth(r);
            for value in gain.iter_mut().flatten() {
                *value = eighth(*value) / s;
            }
        }
        let states = self.bias.iter_mut().zip(&mut self.rate).zip(&mut self.offset);
        for (((bias, rate), offset), gain) in states.zip(&gain) {
            let [of_bias, of_rate, of_offset] = *gain;
            *bias = *bias + (of_bias * nu).to_turns();
            *rate += of_rate * nu;
            *offset += of_offset * nu;
        }
        self.reduce(&gain, cross);
    }

    /// P = P⁻ − K (P⁻Hᵀ)ᵀ: one half, and its mirror.
    fn reduce(&mut self, gain: &Row<S, N>, cross: &Row<S, N>) {
        let p = &mut self.covariance;
        // Indices that the loops bound by the arrays' lengths: the compiler leaves out their checks.
        for j in 0..N {
            for k in 0..3 {
                for m in j..N {
                    for n in if m == j { k } else { 0 }..3 {
                        let value = p[j][k][m][n] - gain[j][k] * cross[m][n];
                        (p[j][k][m][n], p[m][n][j][k]) = (value, value);
                    }
                }
                if p[j][k][j][k] < S::constant(SMALLEST) {
                    p[j][k][j][k] = S::constant(SMALLEST);
                }
            }
        }
    }
}
