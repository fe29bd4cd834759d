//! `[tuning]`: what a table was tuned on, and what came of it.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::check::{ensure, within};
use crate::file::FileError;

/// Largest RMSE that a table may record, mm or degrees.
const MAX_RMSE: f64 = 1e9;

/// How a table was tuned. It is a record; nothing is computed from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TuningKeys {
    /// The training sessions, as they were named.
    pub sessions: Vec<String>,
    /// Iterations of the descent.
    pub iterations: u64,
    /// The iteration whose parameters the table has; 0: those from before.
    pub kept: u64,
    /// Why the descent stopped.
    pub stopped: Stopped,
    /// What all variances of `[uncertainty]` were multiplied by, as far as the format goes; `None` where the table has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variances: Option<f64>,
    /// Parameters of the bias filter; `None` where the anchor corrects the drift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<DriftTuningKeys>,
    /// The record of version 0.1's observer: accepted, not kept.
    #[serde(default, skip_serializing)]
    pub observer: IgnoredAny,
    /// Errors on the sessions but for what was held back, with the table from before.
    pub before: RmseKeys,
    /// The same with this table.
    pub after: RmseKeys,
    /// Errors on the part of each session that was held back, with the table from before.
    pub held_back_before: RmseKeys,
    /// The same with this table.
    pub held_back_after: RmseKeys,
}

/// The bias filter's parameters, each before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriftTuningKeys {
    /// Runs of the estimator that were tried.
    pub runs: u64,
    /// Of `[drift]`, as the others are.
    pub rate_deg_per_s: [f64; 2],
    /// Of `[drift]`.
    pub rate_random_walk_deg_per_s_sqrt_s: [f64; 2],
    /// Of `[drift]`.
    pub angle_random_walk_deg_per_sqrt_s: [f64; 2],
    /// Of `[drift]`.
    pub offset_deg: [f64; 2],
    /// Of `[drift]`.
    pub offset_s: [f64; 2],
}

/// Root mean square errors of fusion over all samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RmseKeys {
    /// Of the ends of all segments.
    pub position_rmse_mm: f64,
    /// Of the tip.
    pub tip_rmse_mm: f64,
    /// Of the headings of all segments' ends.
    pub heading_rmse_deg: f64,
}

/// Why a descent stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stopped {
    /// The RMSE fell no further.
    Converged,
    /// Somebody ended it.
    Interrupted,
}

impl TuningKeys {
    pub(crate) fn check(&self) -> Result<(), FileError> {
        ensure(!self.sessions.is_empty(), "tuning.sessions", &"[]", "at least one session")?;
        let (kept, iterations) = (self.kept, self.iterations);
        ensure(kept <= iterations, "tuning.kept", &kept, &format!("at most the {iterations} of tuning.iterations"))?;
        within("tuning.variances", self.variances.unwrap_or(1.0), 1.0..=f64::MAX)?;
        let parts = [
            ("before", &self.before),
            ("after", &self.after),
            ("held_back_before", &self.held_back_before),
            ("held_back_after", &self.held_back_after),
        ];
        parts.into_iter().try_for_each(|(name, part)| part.check(&format!("tuning.{name}")))
    }
}

impl RmseKeys {
    fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.position_rmse_mm"), self.position_rmse_mm, 0.0..=MAX_RMSE)?;
        within(&format!("{key}.tip_rmse_mm"), self.tip_rmse_mm, 0.0..=MAX_RMSE)?;
        within(&format!("{key}.heading_rmse_deg"), self.heading_rmse_deg, 0.0..=MAX_RMSE)
    }
}
