//! `bend_error`: errors of the bend sensors of a segment, from the residuals of the calibration sweep.

use estimator_core::{BendErrorConfig, Q, SENSORS_PER_SEGMENT, TIME_UNIT_S};
use serde::{Deserialize, Serialize};

use crate::error::{FileError, ensure, within};
use crate::variance::variance;

/// Largest standard deviation of a bend sensor that the bias filter's fixed point holds.
const MAX_DEVIATION_DEG: f64 = 5.0;
/// Threshold of a sensor's step, in standard deviations of its noise, and its minimum in degrees.
const STEP_DEVIATIONS: f64 = 8.0;
const LEAST_STEP_DEG: f64 = 6.0;

/// `bend_error`: standard deviations and correlation of the sweep's residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BendErrorToml {
    /// Deviation of the mean of the segment's sensors.
    pub mean_deg: f64,
    /// Deviation of each sensor.
    pub sensor_deg: Vec<f64>,
    /// Deviation of the change from one value to the next at 10 Hz, of the noisier sensor.
    #[serde(default)]
    pub noise_deg: f64,
    /// Deviation of half the difference of a and b.
    pub difference_deg: f64,
    /// Deviation of 60 s means of half the difference.
    pub slow_difference_deg: f64,
    /// Variance of 60 s means of the mean over that of half the difference, 0 to 1.
    pub slow_ratio: f64,
    /// Correlation length of the error: travel after which it is independent.
    pub travel_deg: f64,
    /// Correlation time of the error, after which it is independent.
    pub correlation_s: f64,
}

impl BendErrorToml {
    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.mean_deg"), self.mean_deg, 0.05..=90.0)?;
        let sensors = self.sensor_deg.len();
        ensure(sensors <= SENSORS_PER_SEGMENT, &format!("{key}.sensor_deg"), &sensors, "one for each sensor")?;
        for deviation in &self.sensor_deg {
            within(&format!("{key}.sensor_deg"), *deviation, 0.05..=90.0)?;
        }
        within(&format!("{key}.noise_deg"), self.noise_deg, 0.0..=90.0)?;
        within(&format!("{key}.difference_deg"), self.difference_deg, 0.0..=90.0)?;
        within(&format!("{key}.slow_difference_deg"), self.slow_difference_deg, 0.0..=90.0)?;
        within(&format!("{key}.slow_ratio"), self.slow_ratio, 0.0..=1.0)?;
        within(&format!("{key}.travel_deg"), self.travel_deg, 0.0..=1000.0)?;
        within(&format!("{key}.correlation_s"), self.correlation_s, 0.0..=1000.0)
    }

    pub(crate) fn compile(&self) -> BendErrorConfig {
        let deviation = |degrees: f64| variance(degrees.min(MAX_DEVIATION_DEG));
        let sensor = |k: usize| deviation(self.sensor_deg.get(k).copied().unwrap_or(self.mean_deg));
        BendErrorConfig {
            mean: deviation(self.mean_deg),
            sensor: [sensor(0), sensor(1)],
            step: Q::from_f64((STEP_DEVIATIONS * self.noise_deg).max(LEAST_STEP_DEG).to_radians()),
            difference: deviation(self.difference_deg),
            slow_difference: Q::from_f64(self.slow_difference_deg.to_radians()),
            slow_ratio: Q::from_f64(self.slow_ratio),
            travel: Q::from_f64(self.travel_deg.to_radians()),
            correlation_time: Q::from_f64(self.correlation_s / TIME_UNIT_S),
        }
    }
}
