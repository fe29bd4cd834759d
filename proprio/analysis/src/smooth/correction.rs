//! Corrections of one row: the change of the filter's biases and offsets by the later readings.

use nalgebra::DMatrix;

use super::adjoint::Adjoint;
use super::step::{STATES, bias, offset, rate};

/// Covariances of the states that a row's headings depend on.
#[derive(Debug)]
pub struct RowCovariance {
    /// T P: of the biases at the time of the row, then of the offsets, with all states.
    with_states: DMatrix<f64>,
    /// Covariance of the biases, rad².
    biases: DMatrix<f64>,
}

/// Smoothed less filtered states of a row, and the smoothed covariance.
#[derive(Debug, Clone, PartialEq)]
pub struct Correction {
    /// Correction of each IMU's bias, rad.
    pub biases: Vec<f64>,
    /// Correction of each segment's offset, rad.
    pub offsets: Vec<f64>,
    /// Smoothed covariance of the biases, rad².
    pub covariance: DMatrix<f64>,
}

impl RowCovariance {
    /// From P; `elapsed` is the time since each segment's last prediction, time units.
    pub fn new(p: &DMatrix<f64>, elapsed: &[f64]) -> Self {
        let n = elapsed.len();
        let with_states = DMatrix::from_fn(2 * n, STATES * n, |j, k| match elapsed.get(j) {
            Some(dt) => p[(bias(j), k)] + dt * p[(rate(j), k)],
            None => p[(offset(j - n), k)],
        });
        let biases = DMatrix::from_fn(n, n, |j, k| with_states[(j, bias(k))] + elapsed[k] * with_states[(j, rate(k))]);
        Self { with_states, biases }
    }

    /// x_s − x = −P λ and P_s = P − P Λ P, for the states that the row's headings depend on.
    pub fn smooth(&self, adjoint: &Adjoint) -> Correction {
        let n = self.biases.nrows();
        let change = -(&self.with_states * &adjoint.vector);
        let of_biases = self.with_states.rows(0, n);
        let covariance = &self.biases - of_biases * &adjoint.matrix * of_biases.transpose();
        let (biases, offsets) = change.as_slice().split_at(n);
        Correction { biases: biases.to_vec(), offsets: offsets.to_vec(), covariance }
    }
}
