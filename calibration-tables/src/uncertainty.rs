//! `[uncertainty]`: error sources of the estimates.

use estimator_core::{Q, UncertaintyConfig, VARIANCE_SCALE};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::error::{FileError, within};
use crate::variance::variance;

/// `[uncertainty]`: standard deviations of the error sources of an estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UncertaintyToml {
    /// Deviation of θ with the moving-average anchor.
    pub theta_deg: f64,
    /// Factor on the bias filter's covariance, which is conservative.
    #[serde(default = "UncertaintyToml::bias_share")]
    pub bias_share: f64,
    /// The factor of version 0.1's observer: accepted, without effect.
    #[serde(default, skip_serializing, rename = "drift_share")]
    pub retired: IgnoredAny,
    /// Deviation of θ measured by bend sensors alone, with the anchor.
    pub bend_deg: f64,
    /// Deviation added by a contact, with the anchor.
    pub contact_deg: f64,
    /// Deviation of each heading's own error, which enters two neighbouring θ with opposite signs.
    pub heading_deg: f64,
    /// Deviation of either coordinate of a segment's end in its own frame, at any bend angle.
    pub end_mm: f64,
}

/// Largest deviation of an angle.
const LARGEST_DEG: f64 = 9.0;
const LARGEST_SHARE: f64 = 10.0;
const LARGEST_MM: f64 = 100.0;

impl UncertaintyToml {
    /// All variances times `factor`, limited to the ranges of the format.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let deviation = |value: f64, largest: f64| (value * factor.sqrt()).min(largest);
        Self {
            theta_deg: deviation(self.theta_deg, LARGEST_DEG),
            bias_share: (self.bias_share * factor).min(LARGEST_SHARE),
            retired: IgnoredAny,
            bend_deg: deviation(self.bend_deg, LARGEST_DEG),
            contact_deg: deviation(self.contact_deg, LARGEST_DEG),
            heading_deg: deviation(self.heading_deg, LARGEST_DEG),
            end_mm: deviation(self.end_mm, LARGEST_MM),
        }
    }

    pub(crate) fn check(&self) -> Result<(), FileError> {
        within("uncertainty.theta_deg", self.theta_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.bias_share", self.bias_share, 0.0..=LARGEST_SHARE)?;
        within("uncertainty.bend_deg", self.bend_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.contact_deg", self.contact_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.heading_deg", self.heading_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.end_mm", self.end_mm, 0.0..=LARGEST_MM)
    }

    pub(crate) fn compile(&self) -> UncertaintyConfig {
        UncertaintyConfig {
            theta: variance(self.theta_deg),
            bias_share: Q::from_f64(self.bias_share),
            bend: variance(self.bend_deg),
            contact: variance(self.contact_deg),
            heading: variance(self.heading_deg),
            end: Q::from_f64((self.end_mm / 1000.0).powi(2) * VARIANCE_SCALE),
        }
    }

    /// Default factor on the bias filter's covariance, below 1 as the priors and the noise of the bend sensors are
    /// conservative.
    #[must_use]
    pub const fn bias_share() -> f64 {
        0.6
    }
}
