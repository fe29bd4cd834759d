//! `proprio check`.

use std::path::Path;

use proprio_check::{CheckedSession, Finding, check};
use proprio_session::LoadedTable;
use serde::Serialize;

use super::warnings::{warn_of_defects, warn_of_missing_history};
use crate::args::CheckArgs;
use crate::arm::ArmSummary;
use crate::error::Error;
use crate::help::Help;
use crate::progress_bar::Bar;
use crate::terminal;

/// What was found of one input.
#[derive(Serialize)]
#[serde(untagged)]
enum Checked {
    /// A session.
    Session(CheckedFile),
    /// An arm description or a table.
    Arm(ArmSummary),
}

/// Findings of one session.
#[derive(Serialize)]
struct CheckedFile {
    path: String,
    samples: u64,
    findings: Vec<Reported>,
}

/// A finding with its text and its remedy.
#[derive(Serialize)]
struct Reported {
    #[serde(flatten)]
    finding: Finding,
    text: String,
    help: String,
}

impl From<Finding> for Reported {
    fn from(finding: Finding) -> Self {
        Self { text: finding.to_string(), help: finding.help(), finding }
    }
}

pub fn run(args: &CheckArgs) -> Result<u8, Error> {
    let table = args.table.as_deref().map(LoadedTable::load).transpose()?;
    let progress = &mut Bar::new();
    let mut checked = Vec::new();
    for path in &args.inputs {
        checked.push(if is_arm(path) {
            Checked::Arm(check_arm(path)?)
        } else {
            let table = table.as_ref().ok_or_else(|| Error::CheckWithoutTable(path.clone()))?;
            Checked::Session(check_session(path, table, progress)?)
        });
    }
    let is_clean = checked.iter().all(Checked::is_clean);
    let text = if args.json {
        terminal::json(&checked)
    } else {
        checked.iter().map(Checked::text).collect::<Vec<_>>().concat()
    };
    terminal::print(&text)?;
    Ok(u8::from(!is_clean))
}

/// True for the name of an arm description or a table.
fn is_arm(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

fn check_arm(path: &Path) -> Result<ArmSummary, Error> {
    let file = LoadedTable::load(path)?.file;
    ArmSummary::of(path, &file).map_err(|source| Error::TableImage { name: path.display().to_string(), source })
}

fn check_session(path: &Path, table: &LoadedTable, progress: &mut Bar) -> Result<CheckedFile, Error> {
    let CheckedSession { samples, missing_history, defects, findings } = check(path, table, progress)?;
    warn_of_defects(path, &defects);
    warn_of_missing_history(path, missing_history);
    let findings = findings.into_iter().map(Reported::from).collect();
    Ok(CheckedFile { path: path.display().to_string(), samples, findings })
}

impl Checked {
    fn is_clean(&self) -> bool {
        match self {
            Self::Session(session) => session.findings.is_empty(),
            Self::Arm(_) => true,
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Session(CheckedFile { path, findings, .. }) => {
                let lines = findings.iter().map(|Reported { text, help, .. }| format!("{path}: {text}; {help}\n"));
                lines.collect::<Vec<_>>().concat()
            }
            Self::Arm(summary) => summary.text(),
        }
    }
}
