//! Filter parameters from the residuals of a calibration.

use crate::file::{NoiseKeys, SegmentKeys};

/// Lag that the default process noise allows the filters, s.
///
/// A random-walk filter follows motion late by about R/Q, with R the variance of both measurements together. The errors
/// of bend sensors and anchored IMUs are slow (hysteresis, creep), so that memory does not average them: the default is
/// a filter that weighs well and remembers little.
pub const LAG_S: f64 = 0.001;

/// Residual of a V–Orient map that does not state its own: the paper's mean.
pub const RMSE_DEG_UNKNOWN: f64 = 4.72;

/// R_imu : R_bend of KF_orient and of KF_coord where no calibration has measured them: what calibrations of the reference
/// arm give.
const ORIENT_RATIO_UNKNOWN: f64 = 0.02;
const COORD_RATIO_UNKNOWN: f64 = 0.1;

impl NoiseKeys {
    /// Parameters for measurements of which the error variances are known: H = 1, and Q = R/[`LAG_S`] with 1/R =
    /// 1/`r_imu` + 1/`r_bend`.
    #[must_use]
    pub fn from_variances(r_imu: f64, r_bend: f64) -> Self {
        let r = r_imu * r_bend / (r_imu + r_bend);
        Self { q: r / LAG_S, r_imu, r_bend, h_imu: 1.0, h_bend: 1.0 }
    }
}

impl SegmentKeys {
    /// KF_orient's parameters: the file's, or those of the maps' residuals.
    #[must_use]
    pub fn orient_or_default(&self) -> NoiseKeys {
        self.orient.clone().unwrap_or_else(|| {
            let sensors = self.bend.as_deref().unwrap_or_default();
            let variance = |rmse_deg: f64| rmse_deg.to_radians().max(1e-4).powi(2);
            let variances = sensors.iter().map(|sensor| variance(sensor.rmse_deg.unwrap_or(RMSE_DEG_UNKNOWN)));
            // The mean of n sensors whose errors are their own.
            let n = sensors.len() as f64;
            let r_bend = if sensors.is_empty() { variance(RMSE_DEG_UNKNOWN) } else { variances.sum::<f64>() / (n * n) };
            NoiseKeys::from_variances(ORIENT_RATIO_UNKNOWN * r_bend, r_bend)
        })
    }

    /// KF_coord's parameters: the file's, or R_bend of KF_orient moved to the arc's end, which an error δθ shifts by L/2 δθ.
    #[must_use]
    pub fn coord_or_default(&self) -> NoiseKeys {
        self.coord.clone().unwrap_or_else(|| {
            let r_bend = self.orient_or_default().r_bend * (self.length_mm / 2000.0).powi(2);
            NoiseKeys::from_variances(COORD_RATIO_UNKNOWN * r_bend, r_bend)
        })
    }
}
