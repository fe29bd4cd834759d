//! `proprio tune`.

use std::io::Write;
use std::path::{Path, PathBuf};

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
    let heed = Heed::interrupts();
    let Tuning { table, record, iteration_time } = tuner.tune(|| heed.is_requested())?;
    drop(heed);
    warnings(&record).for_each(|warning| super::warn(&warning));
    file.write_all(table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    super::print(&tables::tuning(&record, iteration_time))?;
    file.finish()
}

/// What is not as it should be, although the table is written.
fn warnings(record: &TuningKeys) -> impl Iterator<Item = String> {
    let TuningKeys { iterations, kept, stopped, .. } = *record;
    let early = match stopped {
        Stopped::Converged => None,
        Stopped::Interrupted => Some(format!("interrupted after {iterations} iterations, before the RMSE converged")),
    };
    let noise = match kept {
        _ if kept == iterations => None,
        0 => Some("what is held back only gets worse: the filters stay as they were; take longer sessions".to_owned()),
        _ => Some(format!(
            "what is held back gets worse in the end: the table has iteration {kept}, the best for it; take longer sessions"
        )),
    };
    early.into_iter().chain(noise)
}
