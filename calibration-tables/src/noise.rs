//! `orient` and `coord`: parameters of a Kalman filter.

use std::ops::RangeInclusive;

use estimator_core::{COVARIANCE_LIMIT, H_LIMIT, KalmanParams, Scalar};
use serde::{Deserialize, Serialize};

use crate::error::{FileError, within};

/// Lag of the filters with the default process noise, s.
///
/// A random-walk filter lags the motion by about R/Q, with R the variance of both measurements together. The errors of
/// bend sensors and anchored IMUs are slow (hysteresis, creep), so that averaging over time does not reduce them: the
/// default filter weights the measurements, and hardly averages over time.
pub const LAG_S: f64 = 0.001;

/// Residual of a V–Orient map without `rmse_deg`: the paper's mean.
pub const RMSE_DEG_UNKNOWN: f64 = 4.72;

/// Range of r_imu over r_bend, outside which fixed point has no digits left for the smaller one.
const VARIANCE_RATIO: RangeInclusive<f64> = 1e-5..=1e5;
/// Range of H: a scale error of the measurement.
pub const H_RANGE: RangeInclusive<f64> = 0.5..=H_LIMIT;

/// Parameters of one segment's filter of KF_orient (rad) or KF_coord (m).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseToml {
    /// Process noise per second.
    pub q: f64,
    /// Variance of the drift-corrected IMU's measurement.
    pub r_imu: f64,
    /// Variance of the bend sensors' measurement.
    pub r_bend: f64,
    /// H of the drift-corrected IMU.
    #[serde(default = "one")]
    pub h_imu: f64,
    /// H of the bend sensors.
    #[serde(default = "one")]
    pub h_bend: f64,
}

fn one() -> f64 {
    1.0
}

impl NoiseToml {
    /// Parameters for measurements of which the error variances are known: H = 1, and Q = R/[`LAG_S`] with 1/R =
    /// 1/`r_imu` + 1/`r_bend`.
    #[must_use]
    pub fn from_variances(r_imu: f64, r_bend: f64) -> Self {
        let r = r_imu * r_bend / (r_imu + r_bend);
        Self { q: r / LAG_S, r_imu, r_bend, h_imu: 1.0, h_bend: 1.0 }
    }

    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.q"), self.q, 0.0..=1e6)?;
        within(&format!("{key}.r_bend"), self.r_bend, 1e-12..=1e6)?;
        within(&format!("{key}.r_imu"), self.r_imu, 1e-12..=1e6)?;
        within(&format!("{key}.r_imu / r_bend"), self.r_imu / self.r_bend, VARIANCE_RATIO)?;
        within(&format!("{key}.h_imu"), self.h_imu, H_RANGE)?;
        within(&format!("{key}.h_bend"), self.h_bend, H_RANGE)
    }

    /// Converts covariances to ratios to the larger R, for samples at `rate_hz`.
    pub(crate) fn compile<S: Scalar>(&self, rate_hz: f64) -> KalmanParams<S> {
        let unit = self.r_imu.max(self.r_bend);
        KalmanParams {
            q: S::from_f64((self.q / rate_hz / unit).min(COVARIANCE_LIMIT)),
            r_imu: S::from_f64(self.r_imu / unit),
            r_bend: S::from_f64(self.r_bend / unit),
            h_imu: S::from_f64(self.h_imu),
            h_bend: S::from_f64(self.h_bend),
        }
    }
}
