//! A session through the estimator, row by row.

use std::fmt;
use std::path::Path;

use estimator_core::{Estimator, FusedOps, Q};
use proprio_session::{FileDefects, FileFormat, LoadedTable, Progress, Row, SessionReader, is_version_0_1, utc_minute};
use telemetry::{Hello, TICK_HZ};

use crate::agreement::RecordedBy;
use crate::error::Error;
use crate::outcome::{HostEstimator, Outcome};

/// Summary of a session.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionSummary {
    /// Number of rows.
    pub samples: u64,
    /// Time from the first row to the last, s.
    pub seconds: f64,
    /// Number of rows before which the board's estimator had samples that are not in the recording: a replay has another
    /// tare than the board, or lacks some of its samples.
    pub not_comparable: u64,
    /// Time of the first sample's arrival, UTC: `2026-11-30 14:05 UTC`; `None` where it is not known.
    pub recorded_at: Option<String>,
    /// The file's defects, past which it was read.
    pub defects: FileDefects,
    /// Facts about a board's recording; `None` for a CSV.
    pub recording: Option<RecordingFacts>,
}

/// Text about the rows of a recording whose estimates cannot be compared with the board's.
#[derive(Debug)]
pub struct NotComparable<'s>(pub &'s SessionSummary);

impl fmt::Display for NotComparable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SessionSummary { samples, not_comparable, .. } = self.0;
        write!(
            f,
            "{not_comparable} of {samples} samples cannot be compared with the board: samples since its last tare before them \
             are not in the recording, so a replay has another tare or drift until the board's next tare"
        )
    }
}

/// Facts about a recording that is replayed.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingFacts {
    /// Version and revision of the board's firmware; `None` where its `Hello` is not in the recording.
    pub firmware: Option<String>,
    /// True where the board's table was that of the replay. `None` where its `Hello` is not in the recording, and for firmware
    /// of version 0.1, in which the same table has another checksum.
    pub table_matches: Option<bool>,
    /// The estimator of the board's firmware.
    pub recorded_by: RecordedBy,
}

impl RecordingFacts {
    fn new(hello: Option<&Hello>, table: &LoadedTable) -> Result<Self, Error> {
        let Some(hello) = hello else {
            return Ok(Self { firmware: None, table_matches: None, recorded_by: RecordedBy::default() });
        };
        let checksum = table.compile::<Q>(TICK_HZ)?.checksum();
        let firmware = Some(format!("{} ({})", hello.firmware, hello.revision));
        Ok(Self {
            firmware,
            table_matches: (!is_version_0_1(&hello.firmware)).then_some(hello.table == checksum),
            recorded_by: RecordedBy::new(&hello.firmware, table.file.drift.as_ref().map(|drift| drift.kind)),
        })
    }
}

/// Replays a session and passes every row with its outcome to `visit`, but those from before the begin of a recording.
///
/// # Errors
/// Errors of the session, the table and `visit`.
///
/// # Panics
/// Never: the checks of the table's file are at least as strict as the estimator's.
pub fn replay<S: FusedOps>(
    session: &Path,
    table: &LoadedTable,
    progress: &mut dyn Progress,
    mut visit: impl FnMut(&Row, &Outcome<S>) -> Result<(), Error>,
) -> Result<SessionSummary, Error> {
    let visit = |row: &Row, outcome: &Outcome<S>| if row.is_recorded() { visit(row, outcome) } else { Ok(()) };
    replay_with_history(session, table, progress, visit)
}

/// As [`replay`], but passes the rows from before the begin of a recording, too.
///
/// # Errors
/// Those of [`replay`].
///
/// # Panics
/// Never, as [`replay`].
pub fn replay_with_history<S: FusedOps>(
    session: &Path,
    table: &LoadedTable,
    progress: &mut dyn Progress,
    mut visit: impl FnMut(&Row, &Outcome<S>) -> Result<(), Error>,
) -> Result<SessionSummary, Error> {
    let mut rows = SessionRows::open(session, table, "replaying", progress)?;
    let compiled = table.compile::<S>(rows.rate_hz(table)?)?;
    let compiled = compiled.config();
    let mut estimator: Box<HostEstimator<S>> = Box::new(Estimator::new(&compiled).expect("the file was checked"));
    while let Some(row) = rows.next_row()? {
        let outcome = Outcome::of_row(&mut estimator, &row);
        visit(&row, &outcome)?;
    }
    rows.summary(table)
}

/// Rows of a session, with their progress and summary.
pub(crate) struct SessionRows<'p> {
    reader: SessionReader,
    progress: &'p mut dyn Progress,
    work: String,
    samples: u64,
    not_comparable: u64,
    first_us: Option<u64>,
    recorded_at: Option<String>,
    last_us: u64,
}

impl<'p> SessionRows<'p> {
    /// Opens a session; `work` names what is done with it.
    pub fn open(
        session: &Path,
        table: &LoadedTable,
        work: &str,
        progress: &'p mut dyn Progress,
    ) -> Result<Self, Error> {
        let reader = SessionReader::open(session, &table.required_columns()?)?;
        let work = format!("{work} {}", session.display());
        Ok(Self {
            reader,
            progress,
            work,
            samples: 0,
            not_comparable: 0,
            first_us: None,
            recorded_at: None,
            last_us: 0,
        })
    }

    /// Rate of the rows; that of the table where there are too few.
    pub fn rate_hz(&self, table: &LoadedTable) -> Result<f64, Error> {
        Ok(self.reader.rate_hz(table.file.rate_hz)?)
    }

    /// The next row.
    pub fn next_row(&mut self) -> Result<Option<Row>, Error> {
        let row = self.reader.next_row()?;
        if let Some(row) = row.as_ref().filter(|row| row.is_recorded()) {
            self.last_us = row.sample.time_us;
            if self.first_us.is_none() {
                self.first_us = Some(self.last_us);
                self.recorded_at = row.board.as_ref().and_then(|board| utc_minute(board.at));
            }
            self.samples += 1;
            self.not_comparable += u64::from(!row.is_comparable());
            self.progress.advance(&self.work, self.reader.progress());
        }
        Ok(row)
    }

    /// The summary, after the last row.
    pub fn summary(self, table: &LoadedTable) -> Result<SessionSummary, Error> {
        let Self { reader, samples, not_comparable, first_us, recorded_at, last_us, .. } = self;
        let recording =
            if reader.kind() == FileFormat::Csv { None } else { Some(RecordingFacts::new(reader.hello(), table)?) };
        let seconds = (last_us - first_us.unwrap_or(last_us)) as f64 / 1e6;
        Ok(SessionSummary { samples, seconds, not_comparable, recorded_at, defects: reader.defects(), recording })
    }
}
