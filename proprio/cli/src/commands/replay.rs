//! `proprio replay`.

use std::path::{Path, PathBuf};

use estimator_core::{FusedOps, Q, saturations};
use proprio_analysis::agreement::Comparison;
use proprio_analysis::estimates::EstimateWriter;
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::{NotComparable, SessionSummary, replay};
use proprio_analysis::session_metrics::{AllMetrics, ByMethod, SessionMetrics};
use proprio_analysis::{Outcome, smooth};
use proprio_check::SessionCheck;
use proprio_session::{LoadedTable, OutputFile, Row};

use super::warnings::{warn_of_defects, warn_of_findings};
use crate::args::ReplayArgs;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;
use crate::text_tables;

pub fn run(args: &ReplayArgs) -> Result<(), Error> {
    if args.out.is_some() && args.sessions.len() != 1 {
        return Err(Error::OneSession(args.sessions.len()));
    }
    let table = LoadedTable::load(&args.table)?;
    let inputs: Vec<&Path> = args.sessions.iter().map(PathBuf::as_path).chain([table.path]).collect();
    let out = args.out.as_deref().map(|out| OutputFile::create(out, &inputs, args.force.existing())).transpose()?;
    let mut out = out.map(|file| EstimateWriter::new(file, &table.file, args.smooth)).transpose()?;
    let metrics = if args.float {
        // The board's fixed-point estimates differ from those of floats.
        replay_all::<f64>(args, &table, out.as_mut(), None)?
    } else {
        replay_all::<Q>(args, &table, out.as_mut(), Some(Comparison::add))?
    };
    match saturations() {
        0 => {}
        times => terminal::warn(&format_args!(
            "fixed point saturated {times} times: a reading or the table is out of range; compare with --float"
        )),
    }
    let text = if args.json { terminal::json(&metrics) } else { text_tables::replay(&metrics) };
    // The file gets its name last, so that a command that fails leaves none.
    terminal::print_beside(args.out.as_deref(), &text)?;
    if let Some(out) = out {
        terminal::eprint_line(&out.finish()?);
    }
    Ok(())
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

/// Compares the board's output of a row.
type Compare<S> = fn(&mut Comparison, &Row, &Outcome<S>);

fn replay_all<S: FusedOps>(
    args: &ReplayArgs,
    table: &LoadedTable,
    mut out: Option<&mut EstimateWriter>,
    compare: Option<Compare<S>>,
) -> Result<AllMetrics, Error> {
    let length_mm = table.file.length_mm();
    let mut all = ErrorMetrics::new(length_mm);
    let mut each = Vec::new();
    let progress = &mut Bar::new();
    for path in &args.sessions {
        let mut errors = ErrorMetrics::new(length_mm);
        let mut comparison = Comparison::default();
        let mut check = SessionCheck::new(table)?;
        let visit = |row: &Row, outcome: &Outcome<S>| {
            check.update(row);
            errors.add(row, outcome);
            if let Some(compare) = compare {
                compare(&mut comparison, row, outcome);
            }
            Ok(out.as_mut().map_or(Ok(()), |out| out.write(outcome))?)
        };
        let summary = if args.smooth {
            smooth::replay(path, table, progress, visit)
        } else {
            replay(path, table, progress, visit)
        };
        let summary = summary?;
        warn_of_defects(path, &summary.defects);
        warn_of_findings(path, &check.findings());
        if summary.not_comparable > 0 {
            terminal::warn(&format_args!("{}: {}", path.display(), NotComparable(&summary)));
        }
        let SessionSummary { samples, seconds, recording, recorded_at, .. } = summary;
        let recorded = recording.filter(|_| compare.is_some()).map(|recording| {
            comparison.table_matches = recording.table_matches;
            let comparison = comparison.of(recording.recorded_by);
            report_agreement(path, &comparison, recording.firmware.as_deref());
            comparison
        });
        all.append(&errors);
        let metrics = ByMethod::from(&errors);
        each.push(SessionMetrics {
            path: path.display().to_string(),
            samples,
            seconds,
            recorded_at,
            metrics,
            recorded,
        });
    }
    Ok(AllMetrics { sessions: each, all: ByMethod::from(&all), length_mm })
}
