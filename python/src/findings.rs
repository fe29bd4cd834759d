//! Warnings about the findings of the session check, as the program gives them.

use std::path::{Path, PathBuf};

use proprio::Help;
use proprio_check::{Finding, check};
use proprio_session::{Error, LoadedTable, Progress};

/// The warnings about the findings in a session, each with its remedy.
pub fn warnings(path: &Path, findings: &[Finding]) -> impl Iterator<Item = String> {
    findings.iter().map(|finding| format!("{}: {finding}; {}", path.display(), finding.help()))
}

/// Checks the sessions of a calibration, a tuning or an alignment, which judge the truth themselves, and warns of the findings
/// that matter to it.
///
/// # Errors
/// Errors of a session or the table.
pub fn of_sessions(
    sessions: &[PathBuf],
    table: &LoadedTable,
    progress: &mut dyn Progress,
    matters: impl Fn(&Finding) -> bool,
) -> Result<Vec<String>, Error> {
    let mut found = Vec::new();
    for path in sessions {
        let mut checked = check(path, table, progress)?;
        if checked.missing_history.is_any() {
            found.push(format!("{}: {}", path.display(), checked.missing_history));
        }
        checked.findings.retain(|finding| !finding.sensor.is_truth() && matters(finding));
        found.extend(warnings(path, &checked.findings));
    }
    Ok(found)
}
