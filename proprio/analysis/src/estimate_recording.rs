//! A replay's samples and estimates as a recording, on the channels of a board's.

use std::io;
use std::path::{Path, PathBuf};

use estimator_core::{Method, Q};
use proprio_session::convert::{Converted, SessionRecorder};
use proprio_session::{Existing, LoadedTable, OutputFile, Progress, Row, SessionError, SessionProblem, WrittenFile};
use telemetry::{Estimate, Event, MAX_SEGMENTS, Message, Uncertainty};

use crate::Outcome;
use crate::error::Error;
use crate::replay::{SessionSummary, replay_with_history};

/// Writer of a recording of samples and estimates.
pub struct EstimateRecorder {
    recorder: SessionRecorder<OutputFile>,
    path: PathBuf,
    segments: usize,
    /// Segments in contact, a bit each.
    contact: u8,
}

impl EstimateRecorder {
    /// Begins `file`, which is to become `path`, for estimates by this table.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written, or where the arm has more segments than a board's messages.
    pub fn new(file: OutputFile, path: &Path, table: &LoadedTable) -> Result<Self, Error> {
        let segments = table.file.segments.len();
        if segments > MAX_SEGMENTS {
            let problem = SessionProblem::TooManySegments(segments);
            return Err(SessionError { path: table.path.to_owned(), line: None, column: None, problem }.into());
        }
        let failed = |source| output_error(path, source);
        let mut recorder = SessionRecorder::new(file, segments, "replay").map_err(failed)?;
        recorder.attach_table(table.file.to_toml().as_bytes()).map_err(failed)?;
        Ok(Self { recorder, path: path.to_owned(), segments, contact: 0 })
    }

    /// Writes a row, which may be from before the begin of a recording, and its estimates.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written.
    pub fn write(&mut self, row: &Row, outcome: &Outcome<Q>) -> Result<(), Error> {
        self.write_row(row, outcome).map_err(|source| output_error(&self.path, source))
    }

    fn write_row(&mut self, row: &Row, outcome: &Outcome<Q>) -> io::Result<()> {
        let tick = self.recorder.row(row, row.truth.iter().any(Option::is_some))?;
        if !row.is_recorded() {
            return Ok(());
        }
        let fusion = &outcome.shapes[Method::Fusion as usize];
        self.recorder.message(&Message::Estimate(Estimate::of(tick, fusion)))?;
        if !outcome.uncertainties.is_empty() || !outcome.contacts.is_empty() {
            let of = Uncertainty::of(tick, self.segments, &outcome.uncertainties, &outcome.contacts);
            self.recorder.message(&Message::Uncertainty(of))?;
        }
        let contacts = outcome.contacts.iter().rev();
        let contact = contacts.fold(0, |mask: u8, contact| mask << 1 | u8::from(contact.in_contact));
        if contact != self.contact {
            self.contact = contact;
            self.recorder.message(&Message::Event(Event::Contact(tick, contact)))?;
        }
        Ok(())
    }

    /// Completes the file; returns it, and notes about what it lacks.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written.
    pub fn finish(self) -> Result<(OutputFile, Vec<String>), Error> {
        let Self { recorder, path, .. } = self;
        recorder.finish().map_err(|source| output_error(&path, source))
    }
}

/// Converts a session to a recording with the estimates of a replay by `table`.
///
/// # Errors
/// Errors of the session, the table and the output.
pub fn convert(
    input: &Path,
    output: &Path,
    table: &LoadedTable,
    existing: Existing,
    progress: &mut dyn Progress,
) -> Result<(Converted, SessionSummary), Error> {
    let file = OutputFile::create(output, &[input, table.path], existing)?;
    let mut recorder = EstimateRecorder::new(file, output, table)?;
    let summary = replay_with_history(input, table, progress, |row, outcome| recorder.write(row, outcome))?;
    let (file, left_out) = recorder.finish()?;
    let written: WrittenFile = file.finish()?;
    Ok((Converted { written, left_out }, summary))
}

fn output_error(path: &Path, source: io::Error) -> Error {
    proprio_session::Error::Output { path: path.to_owned(), source }.into()
}
