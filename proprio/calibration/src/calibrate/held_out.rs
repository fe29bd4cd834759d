//! Comparison of the methods on the last fifth of each session, by a table that was derived from the rest.

use std::path::PathBuf;

use estimator_core::{Method, Q};
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::replay;
use proprio_session::{LoadedTable, Progress};

use super::derive;
use super::error::Warning;
use super::options::CalibrationOptions;
use super::sweep::Sweep;
use crate::error::Error;

/// Share of a session that is held out.
const SHARE: f64 = 0.2;
/// Ratio of the fusion's error to that of the best single method above which there is a warning.
const WORSE: f64 = 1.1;

/// Errors on the rows that were held out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// RMSE of the tip by each of [`Method::ALL`], mm; `None` where it is never known.
    pub tip_rmse_mm: [Option<f64>; Method::ALL.len()],
}

/// Replays whole sessions, as headings need the tare, and evaluates their last fifth; `None` where the rest makes no table.
pub(super) fn evaluate(
    sweep: &Sweep,
    sessions: &[PathBuf],
    arm: &LoadedTable,
    options: CalibrationOptions,
    progress: &mut dyn Progress,
) -> Result<Option<HeldOut>, Error> {
    let is_held_out = sweep.last_rows(SHARE);
    let Ok(derived) = derive::table(&sweep.without_last(SHARE), sessions, arm, options, &mut Vec::new(), progress)
    else {
        return Ok(None);
    };
    let table = LoadedTable { file: derived.table, path: arm.path };
    let mut errors = ErrorMetrics::new(table.file.length_mm());
    let mut rows = is_held_out.into_iter();
    for (session, left_out) in sessions.iter().zip(&sweep.left_out) {
        let mut number = 0;
        replay::<Q>(session, &table, progress, |row, outcome| {
            if rows.next().is_some_and(|is_held_out| is_held_out) {
                errors.add(&left_out.without(row, number), outcome);
            }
            number += 1;
            Ok(())
        })?;
    }
    Ok(Some(HeldOut { tip_rmse_mm: errors.metrics().map(|metrics| metrics.tip_rmse_mm) }))
}

impl HeldOut {
    /// The warning where a single method is better than all sensors together.
    pub(super) fn warning(&self) -> Option<Warning> {
        let fusion_mm = self.tip_rmse_mm[Method::Fusion as usize]?;
        let others = Method::ALL.into_iter().filter(|method| *method != Method::Fusion);
        let known = others.filter_map(|method| Some((method.name(), self.tip_rmse_mm[method as usize]?)));
        let (method, best_mm) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (fusion_mm > WORSE * best_mm).then_some(Warning::FusionIsWorse { method, best_mm, fusion_mm })
    }
}

#[cfg(test)]
mod tests {
    use super::HeldOut;

    #[test]
    fn a_method_that_is_better_than_fusion_is_warned_about() {
        let warning = |fusion| HeldOut { tip_rmse_mm: [Some(20.0), Some(30.0), Some(10.0), Some(fusion)] }.warning();
        assert!(warning(10.5).is_none());
        assert!(warning(12.0).expect("20 % worse").to_string().contains("imu_c alone is better"));
    }

    #[test]
    fn an_arm_without_truth_in_the_last_fifth_is_not_compared() {
        assert!(HeldOut { tip_rmse_mm: [None; 4] }.warning().is_none());
    }
}
