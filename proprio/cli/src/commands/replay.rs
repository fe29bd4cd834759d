//! `proprio replay`.

use std::path::{Path, PathBuf};

use estimator_core::{FusedOps, Q, saturations};
use proprio_analysis::agreement::Comparison;
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::{NotComparable, SessionSummary, replay_with_history};
use proprio_analysis::session_metrics::{AllMetrics, ByMethod, SessionMetrics};
use proprio_analysis::{Outcome, smooth};
use proprio_check::{Finding, SessionCheck};
use proprio_session::{LoadedTable, Progress, Row};

use super::estimate_output::EstimateOutput;
use super::parallel::each_in_order;
use super::warnings::{warn_of_defects, warn_of_findings};
use crate::args::ReplayArgs;
use crate::error::Error;
use crate::error_table;
use crate::terminal;

pub fn run(args: &ReplayArgs) -> Result<(), Error> {
    if args.out.is_some() && args.sessions.len() != 1 {
        return Err(Error::OneSession(args.sessions.len()));
    }
    let table = LoadedTable::load(&args.table)?;
    let inputs: Vec<&Path> = args.sessions.iter().map(PathBuf::as_path).chain([table.path]).collect();
    let mut out = args.out.as_deref().map(|out| EstimateOutput::create(out, args, &table, &inputs)).transpose()?;
    let metrics = if args.float {
        // The board's fixed-point estimates differ from those of floats.
        replay_all::<f64>(args, &table, out.as_mut(), (None, EstimateOutput::write_csv))?
    } else {
        replay_all::<Q>(args, &table, out.as_mut(), (Some(Comparison::add), EstimateOutput::write))?
    };
    match saturations() {
        0 => {}
        times => terminal::warn(&format_args!(
            "fixed point saturated {times} times: a reading or the table is out of range; compare with --float"
        )),
    }
    let text = if args.json { terminal::json(&metrics) } else { error_table::errors(&metrics) };
    // The file gets its name last, so that a command that fails leaves none.
    terminal::print_beside(args.out.as_deref(), &text)?;
    if let Some(out) = out {
        terminal::eprint_line(&out.finish()?);
    }
    Ok(())
}

/// Comparison of the board's output of a row with its outcome, and the way in which an outcome is written.
type Uses<S> = (Option<fn(&mut Comparison, &Row, &Outcome<S>)>, Write<S>);
/// Writes the outcome of a row.
type Write<S> = fn(&mut EstimateOutput, &Row, &Outcome<S>) -> Result<(), proprio_analysis::Error>;

/// A session that was replayed.
struct Replayed {
    summary: SessionSummary,
    errors: ErrorMetrics,
    comparison: Option<Comparison>,
    findings: Vec<Finding>,
}

fn replay_all<S: FusedOps>(
    args: &ReplayArgs,
    table: &LoadedTable,
    out: Option<&mut EstimateOutput>,
    uses: Uses<S>,
) -> Result<AllMetrics, Error> {
    let length_mm = table.file.length_mm();
    let mut all = ErrorMetrics::new(length_mm);
    let mut each = Vec::new();
    let take = |path: &PathBuf, replayed: Replayed| {
        warn_of_defects(path, &replayed.summary.defects);
        warn_of_findings(path, &replayed.findings);
        all.append(&replayed.errors);
        each.push(metrics(path, replayed));
    };
    // One session may have an output, which one thread writes.
    let out = out.map(std::sync::Mutex::new);
    let replay = |path: &PathBuf, progress: &mut dyn Progress| {
        let mut out = out.as_ref().map(|out| out.lock().expect("one thread writes"));
        replay_one(path, args.smooth, table, progress, out.as_deref_mut().map(|out| &mut **out), uses)
    };
    each_in_order("replaying", &args.sessions, replay, take)?;
    Ok(AllMetrics { sessions: each, all: ByMethod::from(&all), length_mm })
}

fn replay_one<S: FusedOps>(
    path: &Path,
    is_smoothed: bool,
    table: &LoadedTable,
    progress: &mut dyn Progress,
    mut out: Option<&mut EstimateOutput>,
    (compare, write): Uses<S>,
) -> Result<Replayed, Error> {
    let mut errors = ErrorMetrics::new(table.file.length_mm());
    let mut comparison = Comparison::default();
    let mut check = SessionCheck::new(table)?;
    let visit = |row: &Row, outcome: &Outcome<S>| {
        if row.is_recorded() {
            check.update(row);
            errors.add(row, outcome);
            if let Some(compare) = compare {
                compare(&mut comparison, row, outcome);
            }
        }
        out.as_mut().map_or(Ok(()), |out| write(out, row, outcome))
    };
    let summary = if is_smoothed {
        smooth::replay(path, table, progress, visit)?
    } else {
        replay_with_history(path, table, progress, visit)?
    };
    let recording = summary.recording.as_ref().filter(|_| compare.is_some());
    let comparison = recording.map(|recording| {
        comparison.table_matches = recording.table_matches;
        comparison.of(recording.recorded_by)
    });
    Ok(Replayed { errors, comparison, findings: check.findings(), summary })
}

/// The metrics of a session, after a report about the board's estimates.
fn metrics(path: &Path, replayed: Replayed) -> SessionMetrics {
    let Replayed { summary, errors, comparison, .. } = replayed;
    if summary.not_comparable > 0 {
        terminal::warn(&format_args!("{}: {}", path.display(), NotComparable(&summary)));
    }
    let SessionSummary { samples, seconds, recording, recorded_at, .. } = summary;
    if let Some(comparison) = &comparison {
        report_agreement(path, comparison, recording.as_ref().and_then(|recording| recording.firmware.as_deref()));
    }
    let metrics = ByMethod::from(&errors);
    SessionMetrics { path: path.display().to_string(), samples, seconds, recorded_at, metrics, recorded: comparison }
}

/// Reports the agreement of the board's estimates with the replay.
fn report_agreement(path: &Path, recorded: &Comparison, firmware: Option<&str>) {
    let line = format!("{}: {recorded}", path.display());
    if recorded.is_exact() {
        terminal::eprint_line(&line);
    } else {
        // Another release may differ in the last bits.
        terminal::warn(&format_args!("{line}; the board ran firmware {}", firmware.unwrap_or("of an unknown version")));
    }
}
