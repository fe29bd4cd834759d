//! `[drift]`: the drift correction of the IMUs, and the priors and noise of the bias filter.

use estimator_core::{BiasFilterConfig, Q, TIME_UNIT_S};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::error::{FileError, within};
use crate::variance::variance;

/// `[drift]`. Deviations are standard deviations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "DriftFile")]
pub struct DriftToml {
    /// Drift correction.
    pub kind: DriftKind,
    /// Deviation of each heading's zero at the end of the tare.
    pub start_deg: f64,
    /// Deviation of each segment's bend angle in the reference pose.
    pub straightness_deg: f64,
    /// Deviation of the turn-on bias of the gyroscopes, the drift's rate at the start.
    pub rate_deg_per_s: f64,
    /// Angle random walk (IEEE Std 952).
    pub angle_random_walk_deg_per_sqrt_s: f64,
    /// Rate random walk (IEEE Std 952).
    pub rate_random_walk_deg_per_s_sqrt_s: f64,
    /// Deviation of the offset of a segment's bend sensors between sessions, which the sweep does not contain.
    pub offset_deg: f64,
    /// Time constant of that offset.
    pub offset_s: f64,
}

/// `[drift]` in files, including those of version 0.1.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DriftFile {
    kind: DriftKind,
    #[serde(default = "DriftToml::start_deg")]
    start_deg: f64,
    #[serde(default = "DriftToml::straightness_deg")]
    straightness_deg: f64,
    #[serde(default = "DriftToml::rate_deg_per_s")]
    rate_deg_per_s: f64,
    #[serde(default = "DriftToml::angle_random_walk")]
    angle_random_walk_deg_per_sqrt_s: f64,
    #[serde(default = "DriftToml::rate_random_walk", alias = "walk_deg_per_s")]
    rate_random_walk_deg_per_s_sqrt_s: f64,
    #[serde(default = "DriftToml::offset_deg")]
    offset_deg: f64,
    #[serde(default = "DriftToml::offset_s")]
    offset_s: f64,
    // Keys of version 0.1's observer, which the bias filter replaced.
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    noise_deg2_s: IgnoredAny,
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    slope: IgnoredAny,
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    gate_deg: IgnoredAny,
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    patience_s: IgnoredAny,
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    jump_deg: IgnoredAny,
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    still_deg: IgnoredAny,
    #[serde(default)]
    #[expect(dead_code, reason = "accepted, without effect")]
    doubt_deg: IgnoredAny,
}

impl From<DriftFile> for DriftToml {
    fn from(file: DriftFile) -> Self {
        let DriftFile {
            kind,
            start_deg,
            straightness_deg,
            rate_deg_per_s,
            angle_random_walk_deg_per_sqrt_s,
            rate_random_walk_deg_per_s_sqrt_s,
            offset_deg,
            offset_s,
            ..
        } = file;
        Self {
            kind,
            start_deg,
            straightness_deg,
            rate_deg_per_s,
            angle_random_walk_deg_per_sqrt_s,
            rate_random_walk_deg_per_s_sqrt_s,
            offset_deg,
            offset_s,
        }
    }
}

/// `kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DriftKind {
    /// The paper's moving average.
    Anchor,
    /// The Kalman filter over the biases of all headings.
    Kalman,
    /// The observer of version 0.1: such a table runs the bias filter.
    Observer,
}

impl DriftToml {
    /// The bias filter with the priors and noise of BNO055 units.
    #[must_use]
    pub fn kalman() -> Self {
        Self {
            kind: DriftKind::Kalman,
            start_deg: Self::start_deg(),
            straightness_deg: Self::straightness_deg(),
            rate_deg_per_s: Self::rate_deg_per_s(),
            angle_random_walk_deg_per_sqrt_s: Self::angle_random_walk(),
            rate_random_walk_deg_per_s_sqrt_s: Self::rate_random_walk(),
            offset_deg: Self::offset_deg(),
            offset_s: Self::offset_s(),
        }
    }

    const fn start_deg() -> f64 {
        0.1
    }

    const fn straightness_deg() -> f64 {
        0.3
    }

    const fn rate_deg_per_s() -> f64 {
        0.05
    }

    const fn angle_random_walk() -> f64 {
        0.01
    }

    const fn rate_random_walk() -> f64 {
        2e-4
    }

    const fn offset_deg() -> f64 {
        1.0
    }

    const fn offset_s() -> f64 {
        1500.0
    }

    pub(crate) fn check(&self) -> Result<(), FileError> {
        within("drift.start_deg", self.start_deg, 0.0..=30.0)?;
        within("drift.straightness_deg", self.straightness_deg, 0.0..=10.0)?;
        within("drift.rate_deg_per_s", self.rate_deg_per_s, 1e-4..=0.2)?;
        within("drift.angle_random_walk_deg_per_sqrt_s", self.angle_random_walk_deg_per_sqrt_s, 1e-3..=1.0)?;
        within("drift.rate_random_walk_deg_per_s_sqrt_s", self.rate_random_walk_deg_per_s_sqrt_s, 1e-5..=0.01)?;
        within("drift.offset_deg", self.offset_deg, 0.0..=20.0)?;
        within("drift.offset_s", self.offset_s, 64.0..=1e6)
    }

    /// The bias filter's configuration.
    pub(crate) fn compile(&self) -> BiasFilterConfig {
        let root_unit = TIME_UNIT_S.sqrt();
        BiasFilterConfig {
            initial_bias: variance(self.start_deg),
            straightness: variance(self.straightness_deg),
            initial_rate: variance(self.rate_deg_per_s * TIME_UNIT_S),
            bias_noise: variance(self.angle_random_walk_deg_per_sqrt_s * root_unit),
            rate_noise: variance(self.rate_random_walk_deg_per_s_sqrt_s * TIME_UNIT_S * root_unit),
            offset: variance(self.offset_deg),
            offset_rate: Q::from_f64(TIME_UNIT_S / self.offset_s),
        }
    }
}
