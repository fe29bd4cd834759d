//! Tuning.

use std::path::PathBuf;

use proprio_calibration::Error;
use proprio_calibration::tune::{Tuner, Tuning};
use proprio_session::{NoProgress, today};
use pyo3::prelude::*;
use serde_json::json;

use crate::calibrate::{truth_report, truth_warnings};
use crate::error::exception;
use crate::findings;
use crate::interrupt::{Interruptible, interruptible};
use crate::table::TableText;

/// Tunes a table; returns its text, the record as JSON, and the warnings. Ctrl-C keeps the best so far.
#[pyfunction]
pub fn tune(py: Python<'_>, sessions: Vec<PathBuf>, table: TableText) -> PyResult<(String, String, Vec<String>)> {
    let run = |progress: &mut Interruptible| {
        let table = table.load()?;
        let tuner = Tuner::new(&sessions, &table, progress)?;
        let mut warnings = findings::of_sessions(&sessions, &table, progress, |_| true)?;
        for (path, defects) in tuner.defects() {
            warnings.extend(defects.warnings().map(|warning| format!("{}: {warning}", path.display())));
        }
        warnings.extend(tuner.truth().flat_map(truth_warnings));
        let truth = truth_report(tuner.truth());
        let is_interrupted = || Python::attach(|py| py.check_signals().is_err());
        let Tuning { mut table, record, .. } = tuner.tune(&mut NoProgress, is_interrupted)?;
        if let Some(record) = &mut table.tuning {
            record.date = Some(today());
        }
        let report = json!({ "tuning": record, "truth": truth });
        Ok::<_, Error>((table.to_toml(), report.to_string(), warnings))
    };
    interruptible(py, run)?.map_err(|error| exception(py, error))
}
