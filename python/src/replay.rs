//! Replay of a session.

use std::path::{Path, PathBuf};

use estimator_core::{FusedOps, Q};
use proprio_analysis::agreement::Comparison;
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::{NotComparable, SessionSummary, replay as replay_session};
use proprio_analysis::session_metrics::{ByMethod, SessionMetrics};
use proprio_analysis::{Error, Outcome, smooth};
use proprio_check::SessionCheck;
use proprio_session::{LoadedTable, Row};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::exception;
use crate::estimates::Estimates;
use crate::findings;
use crate::interrupt::{Interruptible, interruptible};
use crate::session::Truths;
use crate::table::TableText;

/// Compares the board's output of a row.
type Compare<S> = fn(&mut Comparison, &Row, &Outcome<S>);

/// Estimates of a session, and its errors against truth.
struct Replayed {
    estimates: Estimates,
    truths: Truths,
    metrics: SessionMetrics,
    warnings: Vec<String>,
}

/// Replays a session; returns its arrays, the metrics as JSON in the form of `proprio replay --json`, and the warnings.
#[pyfunction]
pub fn replay(
    py: Python<'_>,
    session: PathBuf,
    table: TableText,
    is_smoothed: bool,
    is_float: bool,
) -> PyResult<(Bound<'_, PyDict>, String, Vec<String>)> {
    let run = |progress: &mut Interruptible| {
        let table = table.load()?;
        if is_float {
            run::<f64>(&session, &table, is_smoothed, progress, None)
        } else {
            run::<Q>(&session, &table, is_smoothed, progress, Some(Comparison::add))
        }
    };
    let replayed = interruptible(py, run)?.map_err(|error| exception(py, error))?;
    let mut arrays = replayed.estimates.into_arrays();
    replayed.truths.add_to(&mut arrays);
    let metrics = serde_json::to_string(&replayed.metrics).expect("numbers and names have a form in JSON");
    Ok((arrays.into_dict(py)?, metrics, replayed.warnings))
}

fn run<S: FusedOps>(
    path: &Path,
    table: &LoadedTable,
    is_smoothed: bool,
    progress: &mut Interruptible,
    compare: Option<Compare<S>>,
) -> Result<Replayed, Error> {
    let segments = table.file.segments.len();
    let (mut estimates, mut truths) = (Estimates::new(segments), Truths::new(segments));
    let mut errors = ErrorMetrics::new(table.file.length_mm());
    let (mut comparison, mut check) = (Comparison::default(), SessionCheck::new(table)?);
    let visit = |row: &Row, outcome: &Outcome<S>| {
        estimates.add(outcome);
        truths.add(row);
        check.update(row);
        errors.add(row, outcome);
        if let Some(compare) = compare {
            compare(&mut comparison, row, outcome);
        }
        Ok(())
    };
    let summary = if is_smoothed {
        smooth::replay(path, table, progress, visit)
    } else {
        replay_session(path, table, progress, visit)
    }?;
    let name = path.display().to_string();
    let mut warnings: Vec<String> = summary.defects.warnings().map(|warning| format!("{name}: {warning}")).collect();
    warnings.extend(findings::warnings(path, &check.findings()));
    if summary.not_comparable > 0 {
        warnings.push(format!("{name}: {}", NotComparable(&summary)));
    }
    let SessionSummary { samples, seconds, recorded_at, recording, .. } = summary;
    let recorded = recording.filter(|_| compare.is_some()).map(|recording| {
        comparison.table_matches = recording.table_matches;
        comparison.of(recording.recorded_by)
    });
    let metrics = ByMethod::from(&errors);
    let metrics = SessionMetrics { path: name, samples, seconds, recorded_at, metrics, recorded };
    Ok(Replayed { estimates, truths, metrics, warnings })
}
