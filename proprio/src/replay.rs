//! A session through the estimator, row by row.

use std::path::Path;

use calibration_tables::{ArmFile, Baked, FileError, MAX_SEGMENTS, MAX_WINDOW};
use estimator_core::{BiasTrace, Conditions, Contacts, Estimate, Estimator, FusedOps, Method, Q, Shape, Uncertainties};
use telemetry::{Hello, TICK_HZ};

use crate::error::Error;
use crate::progress::Progress;
use crate::recording::{RecordedBy, is_version_0_1};
use crate::session::{Kind, Needs, Row, SessionReader};
use crate::smooth::Smoothed;

/// The estimator with room for every arm.
pub type HostEstimator<'t, S> = Estimator<'t, S, MAX_SEGMENTS, { MAX_WINDOW as usize }>;

/// A table and the file that it came from.
#[derive(Debug, Clone)]
pub struct NamedTable<'p> {
    /// The table.
    pub file: ArmFile,
    /// Where it was read.
    pub path: &'p Path,
}

impl<'p> NamedTable<'p> {
    /// Reads and checks an arm description or table.
    ///
    /// # Errors
    /// [`Error::Table`].
    pub fn load(path: &'p Path) -> Result<Self, Error> {
        let file = ArmFile::load(path).map_err(|source| Error::Table { path: path.to_owned(), source })?;
        Ok(Self { file, path })
    }

    /// The file's text as it stands.
    ///
    /// # Errors
    /// [`Error::Table`].
    pub fn toml(&self) -> Result<Vec<u8>, Error> {
        std::fs::read(self.path).map_err(|source| self.error(source.into()))
    }

    /// The columns that it needs of a session.
    ///
    /// # Errors
    /// [`Error::Table`] on an arm description.
    pub fn needs(&self) -> Result<Needs, Error> {
        Needs::of_table(&self.file).map_err(|source| self.error(source))
    }

    /// The estimator's parameters for one sample rate.
    ///
    /// # Errors
    /// [`Error::Table`] on an arm description.
    pub fn bake<S: FusedOps>(&self, rate_hz: f64) -> Result<Baked<S>, Error> {
        self.file.bake(rate_hz).map_err(|source| self.error(source))
    }

    /// Whether the bias filter corrects the drift.
    #[must_use]
    pub fn has_bias_filter(&self) -> bool {
        self.file.bias_filter().is_some()
    }

    fn error(&self, source: FileError) -> Error {
        Error::Table { path: self.path.to_owned(), source }
    }
}

/// What the estimator says of one row.
#[derive(Debug, Clone)]
pub struct Outcome<S> {
    /// The estimate.
    pub estimate: Estimate<S, MAX_SEGMENTS>,
    /// The shape by each of [`Method::ALL`].
    pub shapes: [Shape<S, MAX_SEGMENTS>; Method::ALL.len()],
    /// How far the fused shape may be off; empty where the table does not say what errors come from.
    pub uncertainties: Uncertainties<MAX_SEGMENTS>,
    /// What touches the segments.
    pub contacts: Contacts<MAX_SEGMENTS>,
    /// Conditions that make the estimate less certain, by segment.
    pub conditions: Conditions<MAX_SEGMENTS>,
    /// The fused shape by the readings after the row too, where the session is [smoothed](crate::smooth).
    pub smoothed: Option<Smoothed<S>>,
}

impl<S: FusedOps> Outcome<S> {
    /// Runs the estimator for one row.
    ///
    /// # Panics
    /// If the estimator has no room for its own table.
    pub fn of_row<T: BiasTrace<Q>>(
        estimator: &mut Estimator<'_, S, MAX_SEGMENTS, { MAX_WINDOW as usize }, T>,
        row: &Row,
    ) -> Self {
        if row.starts {
            estimator.start().expect("the estimator has room for its table");
        }
        let estimate = estimator.update_full(&row.sample);
        let shapes = Method::ALL.map(|method| estimator.shape(&estimate, method));
        let (uncertainties, contacts) = (estimator.uncertainties(), estimator.contacts());
        Self { estimate, shapes, uncertainties, contacts, conditions: estimator.conditions(), smoothed: None }
    }
}

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
        let checksum = table.bake::<Q>(TICK_HZ)?.checksum();
        let firmware = Some(format!("{} ({})", hello.firmware, hello.revision));
        Ok(Self {
            firmware,
            table_matches: (!is_version_0_1(&hello.firmware)).then_some(hello.table == checksum),
            recorded_by: RecordedBy::new(&hello.firmware, table.file.drift.as_ref().map(|drift| drift.kind)),
        })
    }
}

/// Replays a session and shows every row and its outcome to `visit`.
///
/// # Errors
/// What is wrong with the session or the table, and whatever `visit` returns.
///
/// # Panics
/// Never: the checks of the table's file are at least as strict as the estimator's.
pub fn replay<S: FusedOps>(
    session: &Path,
    table: &NamedTable,
    mut visit: impl FnMut(&Row, &Outcome<S>) -> Result<(), Error>,
) -> Result<Extent, Error> {
    let mut rows = SessionRows::open(session, table, "replaying")?;
    let baked = table.bake::<S>(rows.rate_hz(table))?;
    let baked = baked.config();
    let mut estimator: Box<HostEstimator<S>> = Box::new(Estimator::new(&baked).expect("the file was checked"));
    while let Some(row) = rows.next_row()? {
        visit(&row, &Outcome::of_row(&mut estimator, &row))?;
    }
    rows.extent(table)
}

/// Rows of a session, with their progress and extent.
pub(crate) struct SessionRows {
    reader: SessionReader,
    progress: Progress,
    samples: u64,
    first_us: Option<u64>,
    last_us: u64,
}

impl SessionRows {
    /// Opens a session; `work` names what is done with it.
    pub fn open(session: &Path, table: &NamedTable, work: &str) -> Result<Self, Error> {
        let reader = SessionReader::open(session, &table.needs()?)?;
        let progress = Progress::new(format!("{work} {}", session.display()), reader.progress().1);
        Ok(Self { reader, progress, samples: 0, first_us: None, last_us: 0 })
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
            self.progress.set(self.reader.progress().0);
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
