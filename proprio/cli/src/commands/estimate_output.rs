//! The output of `replay --out`: estimates as CSV or as a recording.

use std::path::Path;

use estimator_core::{FusedOps, Q};
use proprio_analysis::Outcome;
use proprio_analysis::estimate_recording::EstimateRecorder;
use proprio_analysis::estimates::EstimateWriter;
use proprio_session::{FileFormat, LoadedTable, OutputFile, Row, WrittenFile};

use crate::args::ReplayArgs;
use crate::error::Error;
use crate::terminal;

/// A file of estimates.
pub enum EstimateOutput {
    Csv(EstimateWriter),
    Recording(Box<EstimateRecorder>),
}

impl EstimateOutput {
    /// Begins the file in the format of its name.
    pub fn create(path: &Path, args: &ReplayArgs, table: &LoadedTable, inputs: &[&Path]) -> Result<Self, Error> {
        let create = || OutputFile::create(path, inputs, args.force.existing());
        if FileFormat::of_output(path) != Some(FileFormat::Recording) {
            return Ok(Self::Csv(EstimateWriter::new(create()?, &table.file, args.smooth)?));
        }
        let options = [(args.smooth, "--smooth"), (args.float, "--float")];
        if let Some((_, option)) = options.into_iter().find(|(is_given, _)| *is_given) {
            return Err(Error::NoChannel { path: path.to_owned(), option });
        }
        Ok(Self::Recording(Box::new(EstimateRecorder::new(create()?, path, table)?)))
    }

    /// Writes a row.
    pub fn write(&mut self, row: &Row, outcome: &Outcome<Q>) -> Result<(), proprio_analysis::Error> {
        match self {
            Self::Csv(_) => self.write_csv(row, outcome),
            Self::Recording(recorder) => recorder.write(row, outcome),
        }
    }

    /// Writes a row of a CSV, which has those of the session alone.
    pub fn write_csv<S: FusedOps>(&mut self, row: &Row, outcome: &Outcome<S>) -> Result<(), proprio_analysis::Error> {
        match self {
            Self::Csv(writer) if row.is_recorded() => Ok(writer.write(outcome)?),
            Self::Csv(_) | Self::Recording(_) => Ok(()),
        }
    }

    /// Completes the file and gives it its name.
    pub fn finish(self) -> Result<WrittenFile, Error> {
        match self {
            Self::Csv(writer) => Ok(writer.finish()?),
            Self::Recording(recorder) => {
                let (file, notes) = recorder.finish()?;
                let written = file.finish()?;
                for note in notes {
                    terminal::warn(&format_args!("{}: {note}", written.path.display()));
                }
                Ok(written)
            }
        }
    }
}
