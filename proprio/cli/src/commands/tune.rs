//! `proprio tune`.

use std::io::Write;
use std::path::{Path, PathBuf};

use calibration_tables::{StopReason, TuningToml};
use proprio_calibration::tune::{Tuner, Tuning};
use proprio_session::{LoadedTable, OutputFile, today};

use super::truth;
use super::warnings::{checked, warn_of_defects};
use crate::args::TuneArgs;
use crate::error::Error;
use crate::interrupt::ShutdownGuard;
use crate::progress_bar::Bar;
use crate::terminal;
use crate::text_tables;

pub fn run(args: &TuneArgs) -> Result<(), Error> {
    let table = LoadedTable::load(&args.table)?;
    let inputs: Vec<&Path> = args.sessions.iter().map(PathBuf::as_path).chain([table.path]).collect();
    let mut file = OutputFile::create(&args.output, &inputs, args.force.existing())?;
    let mut progress = Bar::new();
    let tuner = Tuner::new(&args.sessions, &table, &mut progress);
    let tuner = checked(tuner, &args.sessions, |_| table.clone(), |_| true)?;
    tuner.defects().for_each(|(path, defects)| warn_of_defects(path, defects));
    tuner.truth().for_each(truth::warn);
    let lines: String = tuner.truth().map(truth::line).collect();
    let shutdown = ShutdownGuard::new();
    let Tuning { mut table, record, iteration_time } = tuner.tune(&mut progress, || shutdown.is_requested())?;
    drop((shutdown, progress));
    warnings(&record).for_each(|warning| terminal::warn(&warning));
    if let Some(record) = &mut table.tuning {
        record.date = Some(today());
    }
    file.write_all(table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    terminal::print_beside(Some(&args.output), &lines)?;
    terminal::print_beside(Some(&args.output), &text_tables::tuning(&record, iteration_time))?;
    terminal::eprint_line(&file.finish()?);
    Ok(())
}

/// Warnings about a tuning whose table is written.
fn warnings(record: &TuningToml) -> impl Iterator<Item = String> {
    let TuningToml { iterations, best_iteration, stop_reason, .. } = *record;
    let early = match stop_reason {
        StopReason::Converged => None,
        StopReason::Interrupted => {
            Some(format!("interrupted after {iterations} iterations, before the RMSE converged"))
        }
    };
    let noise = match best_iteration {
        _ if best_iteration == iterations => None,
        0 => Some(
            "the validation error did not improve: the filters are unchanged; use longer training sessions".to_owned(),
        ),
        _ => Some(format!(
            "the validation error rises at the end: the table has iteration {best_iteration}, the best by it; use longer training \
             sessions"
        )),
    };
    early.into_iter().chain(noise)
}
