//! `[drift]`: which correction takes the drift out of the IMUs, and the observer's parameters.

use std::ops::RangeInclusive;

use estimator_core::{ObserverRule, Turns};
use serde::{Deserialize, Serialize};

use crate::check::within;
use crate::file::FileError;

/// `[drift]`. Deviations are standard deviations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriftKeys {
    /// Which correction.
    pub kind: DriftKind,
    /// Density of the bend sensors' error: its variance times the time that it lasts, degrees² s.
    #[serde(default = "DriftKeys::noise_deg2_s")]
    pub noise_deg2_s: f64,
    /// Deviation of the bias at the end of the tare.
    #[serde(default = "DriftKeys::start_deg")]
    pub start_deg: f64,
    /// Deviation of the drift's rate at the start.
    #[serde(default = "DriftKeys::rate_deg_per_s")]
    pub rate_deg_per_s: f64,
    /// Deviation of what the rate changes by in a second.
    #[serde(default = "DriftKeys::walk_deg_per_s")]
    pub walk_deg_per_s: f64,
    /// Deviation of the slope: how wrong a map's or a gyroscope's sensitivity is.
    #[serde(default = "DriftKeys::slope")]
    pub slope: f64,
    /// Disagreements that are off by more are left out,
    #[serde(default = "DriftKeys::gate_deg")]
    pub gate_deg: f64,
    /// for this time at most.
    #[serde(default = "DriftKeys::patience_s")]
    pub patience_s: f64,
    /// A step of an IMU from one value to the next that is no motion.
    #[serde(default = "DriftKeys::jump_deg")]
    pub jump_deg: f64,
    /// What is no motion yet.
    #[serde(default = "DriftKeys::still_deg")]
    pub still_deg: f64,
    /// Deviation of the bias from which on an arm at rest teaches it, too: that of the bend sensors.
    #[serde(default = "DriftKeys::doubt_deg")]
    pub doubt_deg: f64,
}

/// `kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriftKind {
    /// The paper's moving average.
    Anchor,
    /// The observer of bias, rate and slope.
    Observer,
}

/// What `noise_deg2_s` may be.
pub const NOISE_RANGE_DEG2_S: RangeInclusive<f64> = 0.01..=1e6;
/// What `walk_deg_per_s` may be.
pub const WALK_RANGE_DEG_PER_S: RangeInclusive<f64> = 0.0..=1.0;
/// What `slope` may be.
pub const SLOPE_RANGE: RangeInclusive<f64> = 0.0..=1.0;

/// One in the units of the observer's variances.
const ONE: f64 = 1_073_741_824.0;
/// Just under half: the observer's largest variance.
const LARGEST: f64 = ONE / 2.0 - 1.0;

impl DriftKeys {
    /// The observer with the parameters of the reference arm.
    #[must_use]
    pub const fn observer() -> Self {
        Self {
            kind: DriftKind::Observer,
            noise_deg2_s: Self::noise_deg2_s(),
            start_deg: Self::start_deg(),
            rate_deg_per_s: Self::rate_deg_per_s(),
            walk_deg_per_s: Self::walk_deg_per_s(),
            slope: Self::slope(),
            gate_deg: Self::gate_deg(),
            patience_s: Self::patience_s(),
            jump_deg: Self::jump_deg(),
            still_deg: Self::still_deg(),
            doubt_deg: Self::doubt_deg(),
        }
    }

    const fn noise_deg2_s() -> f64 {
        50.0
    }

    const fn start_deg() -> f64 {
        0.3
    }

    const fn rate_deg_per_s() -> f64 {
        0.05
    }

    const fn walk_deg_per_s() -> f64 {
        2e-4
    }

    const fn slope() -> f64 {
        0.15
    }

    const fn gate_deg() -> f64 {
        8.0
    }

    const fn patience_s() -> f64 {
        30.0
    }

    const fn jump_deg() -> f64 {
        12.0
    }

    const fn still_deg() -> f64 {
        1.0
    }

    const fn doubt_deg() -> f64 {
        2.5
    }

    pub(crate) fn check(&self) -> Result<(), FileError> {
        within("drift.noise_deg2_s", self.noise_deg2_s, NOISE_RANGE_DEG2_S)?;
        within("drift.start_deg", self.start_deg, 0.0..=360.0)?;
        within("drift.rate_deg_per_s", self.rate_deg_per_s, 0.0..=10.0)?;
        within("drift.walk_deg_per_s", self.walk_deg_per_s, WALK_RANGE_DEG_PER_S)?;
        within("drift.slope", self.slope, SLOPE_RANGE)?;
        within("drift.gate_deg", self.gate_deg, 0.1..=180.0)?;
        within("drift.patience_s", self.patience_s, 0.0..=1e4)?;
        within("drift.jump_deg", self.jump_deg, 0.1..=180.0)?;
        within("drift.still_deg", self.still_deg, 0.0..=180.0)?;
        within("drift.doubt_deg", self.doubt_deg, 0.0..=180.0)
    }

    /// R for values at `rate_hz`, degrees².
    pub(crate) fn measurement_deg2(&self, rate_hz: f64) -> f64 {
        self.noise_deg2_s * rate_hz
    }

    /// The observer's parameters for values at `rate_hz`.
    pub(crate) fn bake(&self, rate_hz: f64) -> ObserverRule {
        let measurement_deg2 = self.measurement_deg2(rate_hz);
        let share = |variance_deg2: f64| (variance_deg2 / measurement_deg2 * ONE).round().min(LARGEST) as i32;
        let variance = |deviation_deg: f64| share(deviation_deg * deviation_deg);
        let degrees = |degrees: f64| Turns::from_rad(degrees.to_radians());
        let walk_deg = self.walk_deg_per_s * ObserverRule::RATE_S;
        ObserverRule {
            step: (f64::powi(2.0, 32) / (rate_hz * ObserverRule::RATE_S)).round() as u32,
            prior: [
                variance(self.start_deg),
                variance(self.rate_deg_per_s * ObserverRule::RATE_S),
                variance(self.slope * 90.0),
            ],
            // A variance that never grows would come to nothing, and the observer to believe nobody.
            growth: [0, share(walk_deg * walk_deg / rate_hz).max(1), 1],
            gate: degrees(self.gate_deg),
            patience: (self.patience_s * rate_hz).round() as u16,
            jump: degrees(self.jump_deg),
            still: degrees(self.still_deg),
            doubt: variance(self.doubt_deg),
        }
    }
}
