//! Drift of a segment's two IMUs against a bend sensor whose map is not known: a Kalman filter learns both.
//!
//! y = b + d + c₁ u + c₂ u², with y the bend angle by the IMUs and u the reading of the sensor. The drift d is a random walk from 0
//! at the begin; offset b, slope c₁ and curvature c₂ of the map are constant.

use nalgebra::{Matrix4, Vector4};

use super::relation::centred;

/// Power spectral density of the error of a quadratic map, degrees² s: 5° that lasts for a second.
const NOISE_DEG2_S: f64 = 50.0;
/// Time within which the drift is followed, s: about a swing of a sweep.
const FOLLOWED_S: f64 = 30.0;
/// Standard deviation of offset, slope and curvature before the first reading, degrees.
const UNKNOWN_DEG: f64 = 3000.0;

/// Filter of one bend sensor.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriftFilter {
    /// b, d, c₁, c₂, degrees.
    state: Vector4<f64>,
    covariance: Matrix4<f64>,
}

impl DriftFilter {
    pub fn new() -> Self {
        let unknown = UNKNOWN_DEG * UNKNOWN_DEG;
        let covariance = Matrix4::from_diagonal(&Vector4::new(unknown, 0.0, unknown, unknown));
        Self { state: Vector4::zeros(), covariance }
    }

    /// Takes a reading and a bend angle that have held for `seconds`.
    pub fn update(&mut self, seconds: f64, counts: u16, angle_deg: f64) {
        if seconds <= 0.0 {
            return;
        }
        self.covariance[(1, 1)] += NOISE_DEG2_S / (FOLLOWED_S * FOLLOWED_S) * seconds;
        let u = centred(counts);
        let row = Vector4::new(1.0, 1.0, u, u * u);
        let cross = self.covariance * row;
        let gain = cross / (row.dot(&cross) + NOISE_DEG2_S / seconds);
        self.state += gain * (angle_deg - row.dot(&self.state));
        let updated = self.covariance - gain * cross.transpose();
        // It stays symmetric in spite of rounding.
        self.covariance = (updated + updated.transpose()) * 0.5;
    }

    /// Drift of the bend angle since the begin, degrees.
    pub fn drift_deg(&self) -> f64 {
        self.state.y
    }
}
