//! `proprio tune`.

use std::io::Write;
use std::path::{Path, PathBuf};

use calibration_tables::{StopReason, TuningToml};
use proprio_calibration::tune::{Tuner, Tuning};
use proprio_session::{LAST_LINE, NamedTable, OutputFile};

use crate::args::Tune;
use crate::error::Error;
use crate::interrupt::ShutdownGuard;
use crate::progress_bar::Bar;
use crate::terminal;
use crate::text_tables;

pub fn run(args: &Tune) -> Result<(), Error> {
    let table = NamedTable::load(&args.table)?;
    let inputs: Vec<&Path> = args.sessions.iter().map(PathBuf::as_path).chain([table.path]).collect();
    let mut file = OutputFile::create(&args.output, &inputs)?;
    let mut progress = Bar::new();
    let tuner = Tuner::new(&args.sessions, &table, &mut progress)?;
    for path in tuner.cut_sessions() {
        terminal::warn(&format_args!("{}: {LAST_LINE}", path.display()));
    }
    let shutdown = ShutdownGuard::new();
    let Tuning { table, record, iteration_time } = tuner.tune(&mut progress, || shutdown.is_requested())?;
    drop((shutdown, progress));
    warnings(&record).for_each(|warning| terminal::warn(&warning));
    file.write_all(table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    terminal::print(&text_tables::tuning(&record, iteration_time))?;
    Ok(file.finish()?)
}

/// What is not as it should be, although the table is written.
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
        0 => Some("what is held back only gets worse: the filters stay as they were; take longer sessions".to_owned()),
        _ => Some(format!(
            "what is held back gets worse in the end: the table has iteration {best_iteration}, the best for it; take longer sessions"
        )),
    };
    early.into_iter().chain(noise)
}
