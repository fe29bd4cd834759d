//! `[contact]` and `[uncertainty]`: when something touches the arm, and how far an estimate may be off.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use estimator_core::{Alike, ContactRule, SCALE, Scalar, Turns, UncertaintyRule};
use serde::{Deserialize, Serialize};

use crate::check::{ensure, within};
use crate::file::FileError;

/// `[contact]`: changes within five values, half a second at 10 Hz, that a free arm does not make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ContactKeys {
    /// Of a segment's IMUs against its bend sensors, a quarter of the motion taken off.
    pub bend_deg: f64,
    /// Of a segment against the one that bends alike.
    pub alike_deg: f64,
}

impl Default for ContactKeys {
    fn default() -> Self {
        Self { bend_deg: 5.0, alike_deg: 4.0 }
    }
}

/// `[uncertainty]`: standard deviations that an estimate's errors come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UncertaintyKeys {
    /// Of θ, whatever is known of the drift.
    pub theta_deg: f64,
    /// Share of the observer's variance of the bias that θ is off by.
    pub drift_share: f64,
    /// Of θ where bend sensors alone tell it.
    pub bend_deg: f64,
    /// Of θ while something touches the segment, beside the others.
    pub contact_deg: f64,
    /// Of each heading by itself: what one θ has too much of it, the next has too little.
    pub heading_deg: f64,
    /// Of either coordinate of a segment's end, whatever its angle.
    pub end_mm: f64,
}

/// `alike`: an earlier segment that bends alike while the arm moves freely, θ = ratio · θ of that one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlikeKeys {
    /// Its number, from 1.
    pub segment: usize,
    /// What its θ is multiplied by.
    pub ratio: f64,
}

impl ContactKeys {
    pub(crate) fn check(&self) -> Result<(), FileError> {
        within("contact.bend_deg", self.bend_deg, 0.1..=90.0)?;
        within("contact.alike_deg", self.alike_deg, 0.1..=90.0)
    }

    pub(crate) fn bake(&self) -> ContactRule {
        let [bend, alike] = [self.bend_deg, self.alike_deg].map(|degrees| Turns::from_rad(degrees.to_radians()));
        ContactRule { bend, alike }
    }
}

/// What the `ratio` of segments that bend alike may be.
pub const RATIO_RANGE: RangeInclusive<f64> = -7.9..=7.9;

/// Largest deviation of an angle.
const LARGEST_DEG: f64 = 9.0;
const LARGEST_SHARE: f64 = 10.0;
const LARGEST_MM: f64 = 100.0;

impl UncertaintyKeys {
    /// All variances times `factor`, or as far as the format goes.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let deviation = |value: f64, largest: f64| (value * factor.sqrt()).min(largest);
        Self {
            theta_deg: deviation(self.theta_deg, LARGEST_DEG),
            drift_share: (self.drift_share * factor).min(LARGEST_SHARE),
            bend_deg: deviation(self.bend_deg, LARGEST_DEG),
            contact_deg: deviation(self.contact_deg, LARGEST_DEG),
            heading_deg: deviation(self.heading_deg, LARGEST_DEG),
            end_mm: deviation(self.end_mm, LARGEST_MM),
        }
    }

    pub(crate) fn check(&self) -> Result<(), FileError> {
        within("uncertainty.theta_deg", self.theta_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.drift_share", self.drift_share, 0.0..=LARGEST_SHARE)?;
        within("uncertainty.bend_deg", self.bend_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.contact_deg", self.contact_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.heading_deg", self.heading_deg, 0.0..=LARGEST_DEG)?;
        within("uncertainty.end_mm", self.end_mm, 0.0..=LARGEST_MM)
    }

    /// For an observer whose measurement has this variance, degrees²; 0 where the anchor corrects the drift.
    pub(crate) fn bake<S: Scalar>(&self, measurement_deg2: f64) -> UncertaintyRule<S> {
        let scaled = |variance: f64| S::from_f64(variance * SCALE);
        let angle = |degrees: f64| scaled(degrees.to_radians().powi(2));
        let measurement = measurement_deg2 * 1_f64.to_radians().powi(2);
        UncertaintyRule {
            theta: angle(self.theta_deg),
            drift: scaled(self.drift_share * measurement / TAU),
            bend: angle(self.bend_deg),
            contact: angle(self.contact_deg),
            heading: angle(self.heading_deg),
            end: scaled((self.end_mm / 1000.0).powi(2)),
        }
    }
}

impl AlikeKeys {
    /// Of the segment of this number.
    pub(crate) fn check(&self, key: &str, segment: usize) -> Result<(), FileError> {
        let is_earlier = (1..segment).contains(&self.segment);
        ensure(is_earlier, &format!("{key}.segment"), &self.segment, "the number of an earlier segment")?;
        within(&format!("{key}.ratio"), self.ratio, RATIO_RANGE)
    }

    pub(crate) fn bake(self) -> Alike {
        Alike { segment: (self.segment - 1) as u8, ratio: (self.ratio * Alike::ONE).round() as i32 }
    }
}
