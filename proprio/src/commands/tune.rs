//! `proprio tune`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use calibration_tables::{Stopped, TuningKeys};
use proprio::error::Error;
use proprio::interrupt::Heed;
use proprio::output::OutputFile;
use proprio::replay::NamedTable;
use proprio::session::LAST_LINE;
use proprio::tune::{Tuner, Tuning};

use crate::cli::Tune;
use crate::tables;

pub fn run(args: &Tune) -> Result<(), Error> {
    let table = NamedTable::load(&args.table)?;
    let inputs: Vec<&Path> = args.sessions.iter().map(PathBuf::as_path).chain([table.path]).collect();
    let mut file = OutputFile::create(&args.output, &inputs)?;
    let tuner = Tuner::new(&args.sessions, &table)?;
    for path in tuner.cut_sessions() {
        super::warn(&format_args!("{}: {LAST_LINE}", path.display()));
    }
    let (heed, start) = (Heed::interrupts(), Instant::now());
    let Tuning { table, record } = tuner.tune(|| heed.is_requested())?;
    let time = start.elapsed();
    drop(heed);
    warn(&record);
    file.write_all(table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    super::print(&tables::tuning(&record, time))?;
    file.finish()
}

/// Says what is not as it should be, although the table is written.
fn warn(record: &TuningKeys) {
    let TuningKeys { iterations, kept, stopped, .. } = record;
    match stopped {
        Stopped::Converged => {}
        Stopped::Interrupted => {
            super::warn(&format_args!("interrupted after {iterations} iterations, before the RMSE converged"))
        }
        Stopped::Iterations => {
            super::warn(&format_args!("the RMSE still falls after {iterations} iterations; tune the table again"))
        }
    }
    match kept {
        0 if *iterations > 0 => super::warn(
            &"no iteration is better on what is held back: the filters stay as they were; take longer sessions",
        ),
        kept if kept < iterations => super::warn(&format_args!(
            "what is held back gets worse in the end: the table has the best for it, iteration {kept}; take longer sessions"
        )),
        _ => {}
    }
}
