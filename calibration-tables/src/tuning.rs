//! `[tuning]`: what a table's filters were tuned on, and what came of it.

use serde::{Deserialize, Serialize};

use crate::check::{ensure, within};
use crate::file::FileError;

/// Largest RMSE that a table may record, mm or degrees.
const MAX_RMSE: f64 = 1e9;

/// How a table's filters were tuned. It is a record; nothing is computed from it.
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
    /// Errors on the sessions but for what was held back, with the filters from before.
    pub before: RmseKeys,
    /// The same with the table's filters.
    pub after: RmseKeys,
    /// Errors on the part of each session that was held back, with the filters from before.
    pub held_back_before: RmseKeys,
    /// The same with the table's filters.
    pub held_back_after: RmseKeys,
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
