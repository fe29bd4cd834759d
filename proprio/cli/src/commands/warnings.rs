//! Warnings about sessions that several commands give: defects of their files, and findings of the session check.

use std::path::{Path, PathBuf};

use proprio_calibration::Error as CalibrationError;
use proprio_check::{CheckedSession, Finding, check};
use proprio_session::{FileDefects, LoadedTable, MissingHistory};

use crate::error::Error;
use crate::help::Help;
use crate::progress_bar::Bar;
use crate::terminal;

/// Warns of the defects of a session's file.
pub fn warn_of_defects(path: &Path, defects: &FileDefects) {
    defects.warnings().for_each(|warning| terminal::warn(&format_args!("{}: {warning}", path.display())));
}

/// Warns of a recording without the samples since the board's last tare.
pub fn warn_of_missing_history(path: &Path, history: MissingHistory) {
    if history.is_any() {
        terminal::warn(&format_args!("{}: {history}", path.display()));
    }
}

/// Warns of the findings of the session check, each with its remedy.
pub fn warn_of_findings(path: &Path, findings: &[Finding]) {
    for finding in findings {
        terminal::warn(&format_args!("{}: {}", path.display(), with_remedy(finding)));
    }
}

/// The text of a finding and its remedy.
pub fn with_remedy(finding: &Finding) -> String {
    format!("{finding}; {}", finding.help())
}

/// Checks the sessions of a calibration, a tuning or an alignment with a table or an arm description and warns of the findings,
/// also where they have been refused: a fault that is found here may be the reason. A pipe is read only once. Findings that do not
/// matter to the command are left out.
pub fn checked<'t, T>(
    result: Result<T, CalibrationError>,
    sessions: &[PathBuf],
    table: impl FnOnce(Option<&T>) -> LoadedTable<'t>,
    matters: impl Fn(&Finding) -> bool,
) -> Result<T, Error> {
    if !matches!(result, Err(CalibrationError::File(_))) {
        let table = table(result.as_ref().ok());
        for path in sessions.iter().filter(|path| path.is_file()) {
            let CheckedSession { missing_history, mut findings, .. } = check(path, &table, &mut Bar::new())?;
            warn_of_missing_history(path, missing_history);
            // These commands judge the truth themselves.
            findings.retain(|finding| !finding.sensor.is_truth() && matters(finding));
            warn_of_findings(path, &findings);
        }
    }
    Ok(result?)
}
