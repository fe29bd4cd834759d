//! `proprio check`.

use std::process::ExitCode;

use proprio_check::{CheckedSession, Finding, check};
use proprio_session::LoadedTable;
use serde::Serialize;

use super::warnings::{warn_of_defects, warn_of_missing_history};
use crate::args::CheckArgs;
use crate::error::Error;
use crate::help::Help;
use crate::progress_bar::Bar;
use crate::terminal;

/// Findings of one session.
#[derive(Serialize)]
struct Checked {
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

pub fn run(args: &CheckArgs) -> Result<ExitCode, Error> {
    let table = LoadedTable::load(&args.table)?;
    let mut checked = Vec::new();
    let progress = &mut Bar::new();
    for path in &args.sessions {
        let CheckedSession { samples, missing_history, defects, findings } = check(path, &table, progress)?;
        warn_of_defects(path, &defects);
        warn_of_missing_history(path, missing_history);
        let findings = findings.into_iter().map(Reported::from).collect();
        checked.push(Checked { path: path.display().to_string(), samples, findings });
    }
    let is_clean = checked.iter().all(|session| session.findings.is_empty());
    let text = if args.json {
        terminal::json(&checked)
    } else {
        let lines = checked.iter().flat_map(|Checked { path, findings, .. }| {
            findings.iter().map(move |Reported { text, help, .. }| format!("{path}: {text}; {help}\n"))
        });
        lines.collect()
    };
    terminal::print(&text)?;
    Ok(if is_clean { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
