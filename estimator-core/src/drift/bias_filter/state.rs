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
/// Smallest variance, 0.004° or 0.004° per time unit: rounding must not bring one to zero.
const SMALLEST: Constant = Constant::new(3e-7);

/// States and covariance.
#[derive(Debug, Clone, Copy)]
pub struct BiasState<S, const N: usize> {
    /// β, from the tare's zero.
    pub bias: [Turns; N],
    /// v, rad per time unit.
    pub rate: [S; N],
    /// o, rad.
    pub offset: [S; N],
    /// P, [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times as large.
    covariance: [[Row<S, N>; 3]; N],
    predicted_at_us: [u64; N],
}

/// Innovation of a scalar measurement: P⁻Hᵀ, and the variance S = H P⁻ Hᵀ without the measurement noise.
pub struct Innovation<S, const N: usize> {
    cross: Row<S, N>,
    /// H P⁻ Hᵀ.
    pub variance: S,
}

impl<S: Scalar, const N: usize> BiasState<S, N> {
    /// Nothing known: zero states without variance.
    pub fn new() -> Self {
        let zero = S::zero();
        Self {
            bias: [Turns::ZERO; N],
            rate: [zero; N],
            offset: [zero; N],
            covariance: [[[[zero; 3]; N]; 3]; N],
            predicted_at_us: [0; N],
        }
    }

    /// The prior at the end of a tare. Each IMU's zero and each segment's straightness have an error of their own; those of
    /// the segments add up along the arm.
    pub fn initialise(&mut self, config: &BiasFilterConfig, straightness: S, offsets: &[S; N], time_us: u64) {
        *self = Self { predicted_at_us: [time_us; N], ..Self::new() };
        for i in 0..N {
            for j in 0..N {
                self.covariance[i][BIAS][j][BIAS] = S::from_int(1 + i.min(j) as i32) * straightness;
            }
            self.covariance[i][BIAS][i][BIAS] += S::from_q(config.initial_bias);
            self.covariance[i][RATE][i][RATE] = S::from_q(config.initial_rate);
            self.covariance[i][OFFSET][i][OFFSET] = offsets[i];
        }
    }

    /// Predicts IMU and segment `i` to `time_us`: x⁻ = A x, P⁻ = A P Aᵀ + Q. The process noise of the offset keeps its
    /// variance at `offset`.
    pub fn predict(&mut self, i: usize, config: &BiasFilterConfig, offset: S, time_us: u64) {
        let Some(dt) = self.elapsed(i, time_us) else { return };
        self.bias[i] = self.bias[i] + (self.rate[i] * dt).to_turns();
        let decay = self.decay_offset(i, config, dt);
        self.propagate(i, dt, decay);
        self.grow(i, BIAS, S::from_q(config.bias_noise) * dt, S::constant(LARGEST));
        self.grow(i, RATE, S::from_q(config.rate_noise) * dt, S::constant(LARGEST_RATE));
        self.grow(i, OFFSET, offset * (S::one() - decay * decay), S::constant(LARGEST));
    }

    /// Predicts IMU and segment `i` while the arm rests: the bias follows the measured heading, not the rate, and its
    /// variance grows by `creep` per time unit alone.
    pub fn predict_at_rest(&mut self, i: usize, config: &BiasFilterConfig, creep: S, time_us: u64) {
        let Some(dt) = self.elapsed(i, time_us) else { return };
        self.bias[i] = self.bias[i] + (self.rate[i] * dt).to_turns();
        self.grow(i, BIAS, creep * dt, S::constant(LARGEST));
        self.grow(i, RATE, S::from_q(config.rate_noise) * dt, S::constant(LARGEST_RATE));
    }

    /// Time since the last prediction, time units; `None` where there is none.
    fn elapsed(&mut self, i: usize, time_us: u64) -> Option<S> {
        let elapsed_us = time_us.checked_sub(self.predicted_at_us[i]).filter(|us| *us > 0)?;
        self.predicted_at_us[i] = time_us;
        let (dt, longest) = (S::from_micros(elapsed_us.min(u64::from(u32::MAX)) as u32), S::constant(LONGEST));
        Some(if dt < longest { dt } else { longest })
    }

    /// The offset's factor over `dt`, applied to the state.
    fn decay_offset(&mut self, i: usize, config: &BiasFilterConfig, dt: S) -> S {
        let share = S::from_q(config.offset_rate) * dt;
        let decay = if share < S::one() { S::one() - share } else { S::zero() };
        self.offset[i] *= decay;
        decay
    }

    /// P ← A P Aᵀ, where A adds the rate times `dt` to the bias and multiplies the offset by `decay`. A bias that is unknown
    /// already learns nothing more from its rate.
    fn propagate(&mut self, i: usize, dt: S, decay: S) {
        let is_known = self.covariance[i][BIAS][i][BIAS] < S::constant(LARGEST);
        let dt = if is_known { dt } else { S::zero() };
        let [mut bias, rate, mut offset] = self.covariance[i];
        for j in 0..N {
            for k in 0..3 {
                bias[j][k] += dt * rate[j][k];
                offset[j][k] *= decay;
            }
        }
        for row in [&mut bias, &mut offset] {
            row[i][BIAS] += dt * row[i][RATE];
            row[i][OFFSET] *= decay;
        }
        let rate_bias = rate[i][BIAS] + dt * rate[i][RATE];
        self.covariance[i][RATE][i][BIAS] = rate_bias;
        self.covariance[i][RATE][i][OFFSET] *= decay;
        self.covariance[i][BIAS] = bias;
        self.covariance[i][OFFSET] = offset;
        self.mirror(i);
    }

    /// Copies the rows of `i` to its columns.
    fn mirror(&mut self, i: usize) {
        let rows = self.covariance[i];
        for (state, row) in rows.iter().enumerate() {
            for j in (0..N).filter(|j| *j != i) {
                for k in 0..3 {
                    self.covariance[j][k][i][state] = row[j][k];
                }
            }
            for k in 0..state {
                self.covariance[i][k][i][state] = row[i][k];
            }
        }
    }

    /// Adds process noise to one state, up to a variance of `limit`.
    pub fn grow(&mut self, i: usize, state: usize, variance: S, limit: S) {
        let diagonal = &mut self.covariance[i][state][i][state];
        if *diagonal < limit {
            *diagonal += variance;
        }
    }

    /// Adds to the variance of a bias that has become doubtful.
    pub fn doubt(&mut self, i: usize, state: usize, variance: S) {
        self.grow(i, state, variance, S::constant(LARGEST));
    }

    /// P of two biases.
    pub fn bias_covariance(&self, i: usize, j: usize) -> S {
        self.covariance[i][BIAS][j][BIAS]
    }

    /// Innovation of segment `i`'s bend sensors against its IMUs, H = (β_i: 1, β_{i−1}: −1, o_i: −1).
    pub fn innovation(&self, i: usize) -> Innovation<S, N> {
        let below = i.checked_sub(1);
        let mut cross = self.covariance[i][BIAS];
        for j in 0..N {
            for k in 0..3 {
                cross[j][k] -= self.covariance[i][OFFSET][j][k];
                if let Some(below) = below {
                    cross[j][k] -= self.covariance[below][BIAS][j][k];
                }
            }
        }
        let variance = cross[i][BIAS] - cross[i][OFFSET] - below.map_or(S::zero(), |below| cross[below][BIAS]);
        Innovation { cross, variance }
    }

    /// Innovation of a change of heading `j` over `dt` of rest, H = (v_j: `dt`).
    pub fn innovation_at_rest(&self, j: usize, dt: S) -> Innovation<S, N> {
        let cross = self.covariance[j][RATE].map(|row| row.map(|value| value * dt));
        Innovation { variance: cross[j][RATE] * dt, cross }
    }

    /// K = P⁻Hᵀ/S, x = x⁻ + K ν, P = P⁻ − K (P⁻Hᵀ)ᵀ, for the innovation ν and measurement noise R.
    pub fn update(&mut self, Innovation { cross, variance }: &Innovation<S, N>, nu: S, r: S) {
        let s = *variance + r;
        let gain = cross.map(|row| row.map(|value| value / s));
        for j in 0..N {
            self.bias[j] = self.bias[j] + (gain[j][BIAS] * nu).to_turns();
            self.rate[j] += gain[j][RATE] * nu;
            self.offset[j] += gain[j][OFFSET] * nu;
            for k in 0..3 {
                self.update_row(j, k, gain[j][k], cross);
            }
        }
    }

    /// One row of P = P⁻ − K (P⁻Hᵀ)ᵀ from the diagonal on, and its mirror.
    fn update_row(&mut self, j: usize, k: usize, gain: S, cross: &Row<S, N>) {
        for m in j..N {
            for n in if m == j { k } else { 0 }..3 {
                let value = self.covariance[j][k][m][n] - gain * cross[m][n];
                self.covariance[j][k][m][n] = value;
                self.covariance[m][n][j][k] = value;
            }
        }
        let diagonal = &mut self.covariance[j][k][j][k];
        if *diagonal < S::constant(SMALLEST) {
            *diagonal = S::constant(SMALLEST);
        }
    }
}
