//! A session through the estimator, row by row.

use std::path::Path;

use estimator_core::{Estimator, FusedOps, Q};
use proprio_session::{Kind, NamedTable, Progress, Row, SessionReader, is_version_0_1};
use telemetry::{Hello, TICK_HZ};

use crate::agreement::RecordedBy;
use crate::error::Error;
use crate::outcome::{HostEstimator, Outcome};

/// The extent of a session.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Number of rows.
    pub samples: u64,
    /// From the first row to the last.
    pub seconds: f64,
    /// Whether the file's last line is ended; if not, its last number may have been cut.
    pub ends_with_line: bool,
    /// Of a board's recording.
    pub recording: Option<Recording>,
}

/// What is known of a recording, when it is replayed.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Version and revision of the board's firmware; `None` where its `Hello` is not in the recording.
    pub firmware: Option<String>,
    /// Whether the board's table was the one of the replay, likewise. `None` of firmware of version 0.1, too, where the same
    /// table had another checksum.
    pub table_matches: Option<bool>,
    /// The estimator of the board's firmware.
    pub recorded_by: RecordedBy,
}

impl Recording {
    fn new(hello: Option<&Hello>, table: &NamedTable) -> Result<Self, Error> {
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

/// Replays a session and passes every row with its outcome to `visit`.
///
/// # Errors
/// Errors of the session, the table and `visit`.
///
/// # Panics
/// Never: the checks of the table's file are at least as strict as the estimator's.
pub fn replay<S: FusedOps>(
    session: &Path,
    table: &NamedTable,
    progress: &mut dyn Progress,
    mut visit: impl FnMut(&Row, &Outcome<S>) -> Result<(), Error>,
) -> Result<Extent, Error> {
    let mut rows = SessionRows::open(session, table, "replaying", progress)?;
    let compiled = table.compile::<S>(rows.rate_hz(table))?;
    let compiled = compiled.config();
    let mut estimator: Box<HostEstimator<S>> = Box::new(Estimator::new(&compiled).expect("the file was checked"));
    while let Some(row) = rows.next_row()? {
        visit(&row, &Outcome::of_row(&mut estimator, &row))?;
    }
    rows.extent(table)
}

/// Rows of a session, with their progress and extent.
pub(crate) struct SessionRows<'p> {
    reader: SessionReader,
    progress: &'p mut dyn Progress,
    work: String,
    samples: u64,
    first_us: Option<u64>,
    last_us: u64,
}

impl<'p> SessionRows<'p> {
    /// Opens a session; `work` names what is done with it.
    pub fn open(session: &Path, table: &NamedTable, work: &str, progress: &'p mut dyn Progress) -> Result<Self, Error> {
        let reader = SessionReader::open(session, &table.needs()?)?;
        let work = format!("{work} {}", session.display());
        Ok(Self { reader, progress, work, samples: 0, first_us: None, last_us: 0 })
    }

    /// Rate of the rows; that of the table where there are too few.
    pub fn rate_hz(&self, table: &NamedTable) -> f64 {
        self.reader.rate_hz(table.file.rate_hz)
    }

    /// The next row.
    pub fn next_row(&mut self) -> Result<Option<Row>, Error> {
        let row = self.reader.next_row()?;
        if let Some(row) = &row {
            self.last_us = row.sample.time_us;
            self.first_us.get_or_insert(self.last_us);
            self.samples += 1;
            self.progress.advance(&self.work, self.reader.progress());
        }
        Ok(row)
    }

    /// The extent, after the last row.
    pub fn extent(self, table: &NamedTable) -> Result<Extent, Error> {
        let Self { reader, samples, first_us, last_us, .. } = self;
        let recording = if reader.kind() == Kind::Csv { None } else { Some(Recording::new(reader.hello(), table)?) };
        let seconds = (last_us - first_us.unwrap_or(last_us)) as f64 / 1e6;
        Ok(Extent { samples, seconds, ends_with_line: reader.ends_with_line(), recording })
    }
}
