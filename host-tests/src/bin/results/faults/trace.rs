//! Errors of a session sample by sample.

use std::ops::Range;

use calibration_tables::{ArmFile, FileError};
use estimator_core::Method;
use host_tests::twin::TwinSession;
use proprio_analysis::consistency::FilterConsistency;
use proprio_analysis::metrics::tip_errors_m;

/// The fused tip in one sample.
#[derive(Debug, Clone, Copy)]
struct Moment {
    time_s: f64,
    /// Distance from the truth; infinite where there is no estimate.
    error_mm: f64,
    is_inside: bool,
    is_flagged: bool,
}

/// The fused tip of a session, from the first estimate on.
pub struct Trace {
    moments: Vec<Moment>,
}

impl Trace {
    /// Replays a session.
    pub fn of(session: &TwinSession, table: &ArmFile) -> Result<Self, FileError> {
        let mut moments = Vec::new();
        session.replay(table, |row, outcome| {
            let mut consistency = FilterConsistency::default();
            consistency.add(row, outcome);
            let error_m = tip_errors_m(row, outcome)[Method::Fusion as usize];
            moments.push(Moment {
                time_s: row.sample.time_us as f64 / 1e6,
                error_mm: error_m.map_or(f64::INFINITY, |error_m| error_m * 1e3),
                is_inside: consistency.metrics().tip_inside_percent.is_some_and(|percent| percent > 50.0),
                is_flagged: outcome.conditions.iter().any(|condition| condition.is_degraded()),
            });
        })?;
        // None before the tare is complete.
        let first = moments.iter().position(|moment| moment.error_mm.is_finite()).unwrap_or(moments.len());
        Ok(Self { moments: moments.split_off(first) })
    }

    fn within(&self, seconds: Range<f64>) -> &[Moment] {
        let index = |time_s: f64| self.moments.partition_point(|moment| moment.time_s < time_s - 1e-6);
        &self.moments[index(seconds.start)..index(seconds.end)]
    }

    /// RMSE of the tip, mm; `None` of no samples.
    pub fn rmse_mm(&self, seconds: Range<f64>) -> Option<f64> {
        let moments = self.within(seconds);
        let sum = moments.iter().map(|moment| moment.error_mm * moment.error_mm).sum::<f64>();
        (!moments.is_empty()).then(|| (sum / moments.len() as f64).sqrt())
    }

    /// Share of true tips inside the 95 % ellipse.
    pub fn inside_percent(&self, seconds: Range<f64>) -> f64 {
        let moments = self.within(seconds);
        100.0 * moments.iter().filter(|moment| moment.is_inside).count() as f64 / moments.len().max(1) as f64
    }

    /// Time from the start of a range to the first sample with a condition.
    pub fn flagged_after_s(&self, seconds: Range<f64>) -> Option<f64> {
        let start_s = seconds.start;
        self.within(seconds).iter().find(|moment| moment.is_flagged).map(|moment| moment.time_s - start_s)
    }

    /// Share of all samples with a condition.
    pub fn flagged_percent(&self) -> f64 {
        let flagged = self.moments.iter().filter(|moment| moment.is_flagged).count();
        100.0 * flagged as f64 / self.moments.len().max(1) as f64
    }
}
