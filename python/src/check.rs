//! The check of a session.

use std::path::PathBuf;

use proprio::Help;
use proprio_check::{CheckedSession, Finding, check as check_session};
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::error::exception;
use crate::interrupt::{Interruptible, interruptible};
use crate::table::TableText;

/// Checks a session; returns the number of samples, the findings as JSON, and the warnings.
#[pyfunction]
pub fn check(py: Python<'_>, session: PathBuf, table: TableText) -> PyResult<(u64, String, Vec<String>)> {
    let run = |progress: &mut Interruptible| check_session(&session, &table.load()?, progress);
    let CheckedSession { samples, missing_history, defects, findings } =
        interruptible(py, run)?.map_err(|error| exception(py, error))?;
    let history = missing_history.is_any().then(|| missing_history.to_string());
    let warnings = defects.warnings().chain(history);
    let warnings = warnings.map(|warning| format!("{}: {warning}", session.display())).collect();
    Ok((samples, findings.iter().map(finding).collect::<Value>().to_string(), warnings))
}

/// A finding in the form of `proprio check --json`.
fn finding(finding: &Finding) -> Value {
    let mut value = serde_json::to_value(finding).expect("every finding has a form in JSON");
    value["text"] = json!(finding.to_string());
    value["help"] = json!(finding.help());
    value
}
