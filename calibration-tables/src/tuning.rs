//! `[tuning]`: what a table was tuned on, and what came of it.

use serde::{Deserialize, Serialize};

use crate::check::{ensure, within};
use crate::drift::{NOISE_RANGE_DEG2_S, SLOPE_RANGE, WALK_RANGE_DEG_PER_S};
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
    /// The drift observer's own parameters; `None` where the anchor corrects the drift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observer: Option<ObserverTuningKeys>,
    /// Errors on the sessions but for what was held back, with the table from before.
    pub before: RmseKeys,
    /// The same with this table.
    pub after: RmseKeys,
    /// Errors on the part of each session that was held back, with the table from before.
    pub held_back_before: RmseKeys,
    /// The same with this table.
    pub held_back_after: RmseKeys,
}

/// The observer's parameters, each before and after.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObserverTuningKeys {
    /// Runs of the estimator that were tried.
    pub runs: u64,
    /// Of `[drift]`, as the others are.
    pub noise_deg2_s: [f64; 2],
    /// Of `[drift]`.
    pub walk_deg_per_s: [f64; 2],
    /// Of `[drift]`.
    pub slope: [f64; 2],
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
        self.observer.as_ref().map_or(Ok(()), ObserverTuningKeys::check)?;
        let parts = [
            ("before", &self.before),
            ("after", &self.after),
            ("held_back_before", &self.held_back_before),
            ("held_back_after", &self.held_back_after),
        ];
        parts.into_iter().try_for_each(|(name, part)| part.check(&format!("tuning.{name}")))
    }
}

impl ObserverTuningKeys {
    fn check(&self) -> Result<(), FileError> {
        let keys = [
            ("noise_deg2_s", self.noise_deg2_s, NOISE_RANGE_DEG2_S),
            ("walk_deg_per_s", self.walk_deg_per_s, WALK_RANGE_DEG_PER_S),
            ("slope", self.slope, SLOPE_RANGE),
        ];
        keys.into_iter().try_for_each(|(name, values, range)| {
            values.into_iter().try_for_each(|value| within(&format!("tuning.observer.{name}"), value, range.clone()))
        })
    }
}

impl RmseKeys {
    fn check(&self, key: &str) -> Result<(), FileError> {
        within(&format!("{key}.position_rmse_mm"), self.position_rmse_mm, 0.0..=MAX_RMSE)?;
        within(&format!("{key}.tip_rmse_mm"), self.tip_rmse_mm, 0.0..=MAX_RMSE)?;
        within(&format!("{key}.heading_rmse_deg"), self.heading_rmse_deg, 0.0..=MAX_RMSE)
    }
}
