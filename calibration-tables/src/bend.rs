//! Bend sensors beyond the paper's quadratic: curves, memory, and the errors that a sweep has left.

use std::ops::RangeInclusive;

use estimator_core::{
    BendErrorConfig, BendMap, BendSensorConfig, CurveMap, Lag, MemoryConfig, Play, Q, QuadraticMap,
    SENSORS_PER_SEGMENT, TIME_UNIT_S,
};
use serde::{Deserialize, Serialize};

use crate::check::{ADC_VOLTS, ensure, within};
use crate::drift::variance;
use crate::file::{BendKeys, FileError, SegmentKeys};

/// Number of points of a curve.
pub const CURVE_POINTS: RangeInclusive<usize> = 2..=65;
/// Largest standard deviation of a bend sensor that the bias filter's fixed point holds.
const MAX_DEVIATION_DEG: f64 = 5.0;
/// A sensor steps where it moves by more than so many standard deviations of its noise, and by so many degrees.
const STEP_DEVIATIONS: f64 = 8.0;
const LEAST_STEP_DEG: f64 = 6.0;
/// Two lags and two plays.
const MEMORIES: usize = 2;

/// `curve`: bend angles at evenly spaced voltages, linear between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveKeys {
    /// Voltage of the first and of the last point.
    pub volts: [f64; 2],
    /// Bend angle at each point.
    pub theta_deg: Vec<f64>,
}

/// `memory`: θ + Σ w (θ − lag(θ)) + Σ w (θ − play(θ)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryKeys {
    /// Time constants of the lags.
    pub lag_s: [f64; MEMORIES],
    /// Their weights.
    pub lag_weight: [f64; MEMORIES],
    /// Radii of the plays.
    pub play_deg: [f64; MEMORIES],
    /// Their weights.
    pub play_weight: [f64; MEMORIES],
}

/// `bend_error`: standard deviations and ranges of the errors that the sweep has left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BendErrorKeys {
    /// Of the mean of the segment's sensors.
    pub mean_deg: f64,
    /// Of each sensor.
    pub sensor_deg: Vec<f64>,
    /// Of the change from one value to the next at 10 Hz, of the noisier sensor.
    #[serde(default)]
    pub noise_deg: f64,
    /// Of half the difference of a and b.
    pub difference_deg: f64,
    /// Of 60 s means of half the difference.
    pub slow_difference_deg: f64,
    /// Variance of 60 s means of the mean over that of half the difference, 0 to 1.
    pub slow_ratio: f64,
    /// Travel after which the error is a new one.
    pub travel_deg: f64,
    /// Time after which the error is a new one.
    pub correlation_s: f64,
}

impl CurveKeys {
    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
        let [lo, hi] = self.volts;
        let in_order = ADC_VOLTS.contains(&lo) && ADC_VOLTS.contains(&hi) && lo < hi;
        ensure(in_order, &format!("{key}.volts"), &format!("[{lo}, {hi}]"), "[lowest, highest] within 0 to 3.3 V")?;
        let (points, theta) = (self.theta_deg.len(), format!("{key}.theta_deg"));
        ensure(CURVE_POINTS.contains(&points), &theta, &format!("{points} angles"), "2 to 65 angles")?;
        for (i, angle) in self.theta_deg.iter().enumerate() {
            within(&format!("{theta}[{}]", i + 1), *angle, -360.0..=360.0)?;
        }
        let steps = || self.theta_deg.windows(2).map(|pair| pair[1] - pair[0]);
        let is_monotonic = steps().all(|step| step >= 0.0) || steps().all(|step| step <= 0.0);
        ensure(is_monotonic, &theta, &"a curve that turns back", "angles that only rise or only fall")
    }

    /// Bend angle at a voltage within the range, rad.
    #[must_use]
    pub fn angle(&self, volts: f64) -> f64 {
        let [lo, hi] = self.volts;
        let last = self.theta_deg.len() - 1;
        let place = ((volts - lo) / (hi - lo) * last as f64).clamp(0.0, last as f64);
        let below = (place as usize).min(last.saturating_sub(1));
        let (a, b) = (self.theta_deg[below], self.theta_deg[(below + 1).min(last)]);
        (a + (b - a) * (place - below as f64)).to_radians()
    }
}

impl MemoryKeys {
    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
        for lag_s in self.lag_s {
            within(&format!("{key}.lag_s"), lag_s, 2.5..=1e4)?;
        }
        for weight in self.lag_weight.iter().chain(&self.play_weight) {
            within(&format!("{key} weight"), *weight, -4.0..=4.0)?;
        }
        for radius in self.play_deg {
            within(&format!("{key}.play_deg"), radius, 0.0..=180.0)?;
        }
        Ok(())
    }

    fn bake(&self) -> MemoryConfig<Q> {
        let lag = |k: usize| Lag {
            time: Q::from_f64(self.lag_s[k] / TIME_UNIT_S),
            rate: Q::from_f64(TIME_UNIT_S / self.lag_s[k]),
            weight: Q::from_f64(self.lag_weight[k]),
        };
        let play = |k: usize| Play {
            radius: Q::from_f64(self.play_deg[k].to_radians()),
            weight: Q::from_f64(self.play_weight[k]),
        };
        MemoryConfig { lags: [lag(0), lag(1)], plays: [play(0), play(1)] }
    }
}

impl BendErrorKeys {
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

    fn bake(&self) -> BendErrorConfig {
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

impl BendKeys {
    /// Map and memory of the sensor.
    pub(crate) fn bake<S: estimator_core::FusedOps>(&self) -> BendSensorConfig<S> {
        let map = match &self.curve {
            Some(curve) => {
                let angles: Vec<f64> = curve.theta_deg.iter().copied().map(f64::to_radians).collect();
                BendMap::Curve(CurveMap::from_volts(&angles, curve.volts))
            }
            None => BendMap::Quadratic(QuadraticMap::from_volts(self.c2, self.c1, self.c0, self.range_volts())),
        };
        BendSensorConfig { map, memory: self.memory.as_ref().map(MemoryKeys::bake) }
    }
}

impl SegmentKeys {
    /// Errors of the bend sensors: those of the sweep, or those that the residuals of the quadratics suggest.
    pub(crate) fn bake_bend_error(&self) -> BendErrorConfig {
        self.bend_error.clone().unwrap_or_else(|| self.default_bend_error()).bake()
    }

    /// Two sensors of one segment with independent errors of the maps' RMSE; correlation as on the paper's sweeps.
    fn default_bend_error(&self) -> BendErrorKeys {
        let sensors = self.bend.as_deref().unwrap_or_default();
        let rmse = |sensor: &BendKeys| sensor.rmse_deg.unwrap_or(crate::noise::RMSE_DEG_UNKNOWN).max(0.3);
        let sensor_deg: Vec<f64> = sensors.iter().map(rmse).collect();
        let n = sensor_deg.len().max(1) as f64;
        let square_sum: f64 = sensor_deg.iter().map(|deviation| deviation * deviation).sum();
        let mean_deg = if sensors.is_empty() { crate::noise::RMSE_DEG_UNKNOWN } else { square_sum.sqrt() / n };
        BendErrorKeys {
            mean_deg,
            sensor_deg,
            noise_deg: 0.0,
            difference_deg: mean_deg,
            slow_difference_deg: mean_deg / 2.0,
            slow_ratio: 1.0,
            travel_deg: 60.0,
            correlation_s: 10.0,
        }
    }
}
