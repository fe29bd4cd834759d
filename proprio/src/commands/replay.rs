//! `proprio replay`.

use std::path::{Path, PathBuf};

use estimator_core::{Q, Scalar, saturations};
use proprio::error::Error;
use proprio::estimates::EstimateWriter;
use proprio::output::OutputFile;
use proprio::replay::{Extent, NamedTable, replay};
use proprio::report::{Methods, Report, SessionReport};
use proprio::score::Score;

use crate::cli::Replay;
use crate::tables;

pub fn run(args: &Replay) -> Result<(), Error> {
    if args.out.is_some() && args.sessions.len() != 1 {
        return Err(Error::OneSession(args.sessions.len()));
    }
    let table = NamedTable::load(&args.table)?;
    let out = args.out.as_deref();
    let report = if args.float {
        replay_all::<f64>(&args.sessions, &table, out)?
    } else {
        replay_all::<Q>(&args.sessions, &table, out)?
    };
    match saturations() {
        0 => {}
        times => super::warn(&format_args!(
            "fixed point saturated {times} times: a reading or the table is out of range; compare with --float"
        )),
    }
    let text = if args.json {
        serde_json::to_string(&report).expect("numbers and names have a form in JSON") + "\n"
    } else {
        tables::replay(&report)
    };
    super::print(&text)
}

fn replay_all<S: Scalar>(sessions: &[PathBuf], table: &NamedTable, out: Option<&Path>) -> Result<Report, Error> {
    let length_mm = table.file.length_mm();
    let mut all = Score::new(length_mm);
    let mut reports = Vec::new();
    for path in sessions {
        let mut score = Score::new(length_mm);
        let extent = match out {
            Some(out) => replay_to_file::<S>(path, table, &mut score, out)?,
            None => replay::<S>(path, table, |row, outcome| {
                score.add(row, outcome);
                Ok(())
            })?,
        };
        all.append(&score);
        let Extent { samples, seconds, ends_with_line } = extent;
        if !ends_with_line {
            super::warn(&format_args!("{}: the last line has no end; its last number may be cut", path.display()));
        }
        let figures = Methods { methods: score.figures() };
        reports.push(SessionReport { path: path.display().to_string(), samples, seconds, figures });
    }
    Ok(Report { sessions: reports, all: Methods { methods: all.figures() }, length_mm })
}

fn replay_to_file<S: Scalar>(path: &Path, table: &NamedTable, score: &mut Score, out: &Path) -> Result<Extent, Error> {
    let output = |source| Error::Output { path: out.to_owned(), source };
    let mut writer = EstimateWriter::new(OutputFile::create(out, &[path, table.path])?, table.file.segments.len())
        .map_err(output)?;
    let extent = replay::<S>(path, table, |row, outcome| {
        score.add(row, outcome);
        writer.write(outcome).map_err(output)
    })?;
    writer.into_inner().finish()?;
    Ok(extent)
}
