//! `bend`: bend sensors, their V–Orient maps (quadratic or curve), and their creep and hysteresis.

use std::ops::RangeInclusive;

use estimator_core::{
    BendMap, BendSensorConfig, CurveMap, FusedOps, Lag, MemoryConfig, Play, Q, QuadraticMap, TIME_UNIT_S,
    VOLTS_PER_COUNT,
};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

use crate::error::{FileError, ensure, within};

/// Largest bend angle of a segment, rad.
const MAX_ANGLE: f64 = std::f64::consts::TAU;
/// Largest coefficient of a map about the middle of its range that fits fixed point, rad.
const MAX_COEFFICIENT: f64 = 31.0;
/// Voltages that the ADC can read, with some room for rounding.
const ADC_VOLTS: RangeInclusive<f64> = -0.001..=3.301;
/// Number of points of a curve.
pub const CURVE_POINTS: RangeInclusive<usize> = 2..=65;
/// Number of lags, and of plays.
const MEMORIES: usize = 2;

/// One bend sensor's V–Orient map, θ = c2 V² + c1 V + c0 in rad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BendToml {
    /// rad.
    pub c0: f64,
    /// rad/V.
    pub c1: f64,
    /// rad/V².
    pub c2: f64,
    /// Residual of the calibration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_deg: Option<f64>,
    /// Lowest and highest voltage of the calibration, V; `None`: those at which |θ| is half a turn.
    #[serde(default, deserialize_with = "pair", skip_serializing_if = "Option::is_none")]
    pub volts: Option<[f64; 2]>,
    /// A curve that replaces the quadratic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<CurveToml>,
    /// Creep and hysteresis of this sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<MemoryToml>,
}

/// `curve`: bend angles at evenly spaced voltages, linear between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveToml {
    /// Voltage of the first and of the last point.
    pub volts: [f64; 2],
    /// Bend angle at each point.
    pub theta_deg: Vec<f64>,
}

/// `memory`: θ + Σ w (θ − lag(θ)) + Σ w (θ − play(θ)).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryToml {
    /// Time constants of the lags.
    pub lag_s: [f64; MEMORIES],
    /// Their weights.
    pub lag_weight: [f64; MEMORIES],
    /// Radii of the plays.
    pub play_deg: [f64; MEMORIES],
    /// Their weights.
    pub play_weight: [f64; MEMORIES],
}

impl CurveToml {
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

impl MemoryToml {
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

    fn compile(&self) -> MemoryConfig<Q> {
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

impl BendToml {
    pub(crate) fn check(&self, key: &str) -> Result<(), FileError> {
        for (name, value) in [("c0", self.c0), ("c1", self.c1), ("c2", self.c2)] {
            within(&format!("{key}.{name}"), value, -1e4..=1e4)?;
        }
        within(&format!("{key}.rmse_deg"), self.rmse_deg.unwrap_or(0.0), 0.0..=360.0)?;
        if let Some(volts) = self.volts {
            self.check_within(key, volts)?;
        }
        self.curve.as_ref().map_or(Ok(()), |curve| curve.check(&format!("{key}.curve")))?;
        self.memory.as_ref().map_or(Ok(()), |memory| memory.check(&format!("{key}.memory")))?;
        let map = QuadraticMap::<f64>::from_volts(self.c2, self.c1, self.c0, self.range_volts());
        let largest = map.coefficients.into_iter().fold(0.0, |largest: f64, b| largest.max(b.abs()));
        ensure(
            largest < MAX_COEFFICIENT,
            key,
            &"a map that is too steep",
            "the angles of a segment, within half a turn",
        )
    }

    fn check_within(&self, key: &str, [lo, hi]: [f64; 2]) -> Result<(), FileError> {
        let volts = format!("{key}.volts");
        let in_order = ADC_VOLTS.contains(&lo) && ADC_VOLTS.contains(&hi) && lo < hi;
        ensure(in_order, &volts, &format!("[{lo}, {hi}]"), "[lowest, highest] within 0 to 3.3 V")?;
        let steepest = [lo, hi].map(|v| self.angle(v).abs()).into_iter().fold(0.0, f64::max);
        within(&format!("{key}: largest angle within volts, rad"), steepest, 0.0..=MAX_ANGLE)?;
        ensure(
            self.is_monotonic_within([lo, hi]),
            key,
            &match self.turning_point() {
                volts if volts.is_finite() => format!("a map that turns back at {volts:.3} V"),
                _ => "a map that stays level".to_owned(),
            },
            &format!("one that only rises or only falls from {lo} V to {hi} V"),
        )
    }

    /// Range of voltages of the map's fit, V; without `volts`, the range in which |θ| is within half a turn.
    #[must_use]
    pub fn range_volts(&self) -> [f64; 2] {
        self.volts.unwrap_or_else(|| {
            let volts = (0..=4095_u16).map(|counts| f64::from(counts) * VOLTS_PER_COUNT);
            let bent = volts.filter(|v| self.angle(*v).abs() <= std::f64::consts::PI);
            let [lo, hi] = bent.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)]);
            if lo < hi { [lo, hi] } else { [0.0, 3.3] }
        })
    }

    /// Bend angle at a voltage, rad.
    #[must_use]
    pub fn angle(&self, volts: f64) -> f64 {
        (self.c2 * volts + self.c1) * volts + self.c0
    }

    /// Returns `true` if the map is strictly monotonic between the two voltages.
    #[must_use]
    pub fn is_monotonic_within(&self, volts: [f64; 2]) -> bool {
        let [at_lo, at_hi] = volts.map(|v| 2.0 * self.c2 * v + self.c1);
        at_lo * at_hi > 0.0
    }

    /// The voltage where the map turns back, V; not finite for a straight line.
    #[must_use]
    pub fn turning_point(&self) -> f64 {
        -self.c1 / (2.0 * self.c2)
    }

    /// Converts the map and the memory of the sensor.
    pub(crate) fn compile<S: FusedOps>(&self) -> BendSensorConfig<S> {
        let map = match &self.curve {
            Some(curve) => {
                let angles: Vec<f64> = curve.theta_deg.iter().copied().map(f64::to_radians).collect();
                BendMap::Curve(CurveMap::from_volts(&angles, curve.volts))
            }
            None => BendMap::Quadratic(QuadraticMap::from_volts(self.c2, self.c1, self.c0, self.range_volts())),
        };
        BendSensorConfig { map, memory: self.memory.as_ref().map(MemoryToml::compile) }
    }
}

/// An array of two numbers, no more.
fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    let numbers = Vec::deserialize(deserializer)?;
    let found = numbers.len();
    let pair = numbers.try_into().map_err(|_: Vec<f64>| D::Error::custom(format!("{found} numbers, expected 2")))?;
    Ok(Some(pair))
}
