//! `[tuning]`: record of a table's tuning, its sessions and its result.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::calibration::check_date;
use crate::error::{FileError, ensure, within};

/// Largest RMSE that a table may record, mm or degrees.
const MAX_RMSE: f64 = 1e9;

/// Record of a table's tuning. The estimator does not use it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TuningToml {
    /// The training sessions, as they were named.
    pub sessions: Vec<String>,
    /// Day of the tuning, UTC: `2026-11-30`; `None` where it is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
    /// Iterations of the descent.
    pub iterations: u64,
    /// The iteration whose parameters the table has; 0: those from before the tuning.
    #[serde(alias = "kept")]
    pub best_iteration: u64,
    /// Reason why the descent stopped.
    #[serde(alias = "stopped")]
    pub stop_reason: StopReason,
    /// Factor on all variances of `[uncertainty]`, which are limited to the ranges of the format; `None` without
    /// `[uncertainty]`.
    #[serde(default, skip_serializing_if = "Option::is_none", alias = "variances")]
    pub covariance_inflation: Option<f64>,
    /// Parameters of the bias filter; `None` if the anchor corrects the drift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftTuningToml>,
    /// The record of version 0.1's observer: accepted, not stored.
    #[serde(default, skip_serializing)]
    pub observer: IgnoredAny,
    /// Errors on the training part of the sessions, with the table from before.
    pub before: RmseToml,
    /// Errors on the training part, with this table.
    pub after: RmseToml,
    /// Errors on the validation part of the sessions, with the table from before.
    #[serde(alias = "held_back_before")]
    pub validation_before: RmseToml,
    /// Errors on the validation part, with this table.
    #[serde(alias = "held_back_after")]
    pub validation_after: RmseToml,
}

/// The bias filter's parameters, each before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriftTuningToml {
    /// Runs of the estimator that were tried.
    pub runs: u64,
    /// Key of `[drift]`.
    pub rate_deg_per_s: [f64; 2],
    /// Key of `[drift]`.
    pub rate_random_walk_deg_per_s_sqrt_s: [f64; 2],
    /// Key of `[drift]`.
    pub angle_random_walk_deg_per_sqrt_s: [f64; 2],
    /// Key of `[drift]`.
    pub offset_deg: [f64; 2],
    /// Key of `[drift]`.
    pub offset_s: [f64; 2],
}

/// Root mean square errors of fusion over all samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RmseToml {
    /// RMSE of the ends of all segments.
    pub position_rmse_mm: f64,
    /// RMSE of the tip.
    pub tip_rmse_mm: f64,
    /// RMSE of the headings of all segments' ends.
    pub heading_rmse_deg: f64,
}

/// Reason why a descent stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum StopReason {
    /// The RMSE fell no further.
    Converged,
    /// The user ended it.
    Interrupted,
}

impl TuningToml {
    pub(crate) fn check(&self) -> Result<(), FileError> {
        ensure(!self.sessions.is_empty(), "tuning.sessions", &"[]", "at least one session")?;
        check_date("tuning.date", self.date.as_deref())?;
        let (best, iterations) = (self.best_iteration, self.iterations);
        let expected = format!("at most the {iterations} of tuning.iterations");
        ensure(best <= iterations, "tuning.best_iteration", &best, &expected)?;
        within("tuning.covariance_inflation", self.covariance_inflation.unwrap_or(1.0), 1.0..=f64::MAX)?;
        let parts = [
            ("before", &self.before),
            ("after", &self.after),
            ("validation_before", &self.validation_before),
            ("validation_after", &self.validation_after),
        ];
        parts.into_iter().try_for_each(|(name, part)| part.check(&format!("tuning.{name}")))
    }
}

impl RmseToml {
    fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.position_rmse_mm"), self.position_rmse_mm, 0.0..=MAX_RMSE)?;
        within(&format!("{key}.tip_rmse_mm"), self.tip_rmse_mm, 0.0..=MAX_RMSE)?;
        within(&format!("{key}.heading_rmse_deg"), self.heading_rmse_deg, 0.0..=MAX_RMSE)
    }
}
