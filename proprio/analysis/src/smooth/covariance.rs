//! The bias filter's covariance in floats, forwards: the gains of all updates.

use estimator_core::{BiasOperation, Q, VARIANCE_SCALE};
use nalgebra::DMatrix;

use super::step::{STATES, SparseRow, Step, bias, offset, rate, sparse_row};

/// Covariance P of the states of all segments, rad² and, of rates, per time unit.
///
/// The operations are those that the estimator has chosen in fixed point; P is computed again from them, so that gains and
/// covariances agree to the rounding of floats and the smoothed covariance is never larger than the filter's.
#[derive(Debug, Clone)]
pub struct CovarianceFilter {
    p: DMatrix<f64>,
    segments: usize,
}

/// A variance as the estimator holds it, rad².
fn variance(value: Q) -> f64 {
    value.to_f64() / VARIANCE_SCALE
}

impl CovarianceFilter {
    /// Before the start of a session.
    pub fn new(segments: usize) -> Self {
        Self { p: DMatrix::zeros(STATES * segments, STATES * segments), segments }
    }

    /// P.
    pub fn p(&self) -> &DMatrix<f64> {
        &self.p
    }

    /// Applies an operation; returns the step that the backward pass must undo.
    pub fn apply(&mut self, operation: &BiasOperation<Q>) -> Option<Step> {
        match *operation {
            BiasOperation::Start { straightness } => {
                self.start(variance(straightness));
                Some(Step::Start)
            }
            BiasOperation::Predict { segment, dt, decay, noise } if segment < self.segments => {
                let (dt, decay) = (dt.to_f64(), decay.to_f64());
                self.predict(segment, dt, decay);
                self.grow(segment, noise);
                Some(Step::Predict { segment, dt, decay })
            }
            BiasOperation::Noise { segment, noise } if segment < self.segments => {
                self.grow(segment, noise);
                None
            }
            BiasOperation::Update { measurement, nu, r } => {
                let row = sparse_row(measurement);
                let (gain, s) = self.update(&row, variance(r));
                Some(Step::Update { row, gain, nu: nu.to_f64(), s })
            }
            BiasOperation::Output | BiasOperation::Predict { .. } | BiasOperation::Noise { .. } => None,
        }
    }

    fn start(&mut self, straightness: f64) {
        self.p.fill(0.0);
        for i in 0..self.segments {
            for j in 0..self.segments {
                self.p[(bias(i), bias(j))] = (1 + i.min(j)) as f64 * straightness;
            }
        }
    }

    /// P ← A P Aᵀ.
    fn predict(&mut self, i: usize, dt: f64, decay: f64) {
        for k in 0..self.p.nrows() {
            self.p[(bias(i), k)] += dt * self.p[(rate(i), k)];
            self.p[(offset(i), k)] *= decay;
        }
        for k in 0..self.p.nrows() {
            self.p[(k, bias(i))] += dt * self.p[(k, rate(i))];
            self.p[(k, offset(i))] *= decay;
        }
    }

    fn grow(&mut self, i: usize, noise: [Q; STATES]) {
        for (state, noise) in [bias(i), rate(i), offset(i)].into_iter().zip(noise) {
            self.p[(state, state)] += variance(noise);
        }
    }

    /// K = P⁻Hᵀ/S, P = P⁻ − K H P⁻; returns K and S.
    fn update(&mut self, row: &SparseRow, r: f64) -> (Vec<f64>, f64) {
        let cross: Vec<f64> =
            (0..self.p.nrows()).map(|k| row.iter().map(|(at, h)| h * self.p[(k, *at)]).sum()).collect();
        let s = r + row.iter().map(|(at, h)| h * cross[*at]).sum::<f64>();
        for j in 0..cross.len() {
            for k in 0..cross.len() {
                self.p[(j, k)] -= cross[j] * cross[k] / s;
            }
        }
        (cross.iter().map(|value| value / s).collect(), s)
    }
}
