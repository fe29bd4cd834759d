//! Reads a session row by row, in memory that does not grow with its length.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use telemetry::{Hello, SEGMENTS};

use super::csv::{CsvRows, ends_with_line};
use super::{Needs, Problem, Row, SessionError};
use crate::recording::{Item, RawReader, ReadError, Reader, RecordedRows, is_recording};

/// Rows at the start whose time stamps tell the sample rate.
const RATE_ROWS: usize = 1001;

/// Bytes at the start that tell what a file is.
pub(super) const BEGIN: u64 = 8;

/// A session that is being read, of any [`Kind`].
pub struct SessionReader {
    path: PathBuf,
    size_bytes: u64,
    rows: Rows,
    ahead: VecDeque<Row>,
    rate_hz: Option<f64>,
    ends_with_line: bool,
    is_regular_file: bool,
    bend_sensors: Vec<[bool; 2]>,
    kind: Kind,
}

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Text, a row a sample.
    Csv,
    /// A board's recording.
    Recording,
    /// The bytes of a board as they came.
    Raw,
}

impl Kind {
    /// By its first bytes; raw bytes have no mark and are known by their name, `.bin`.
    pub(super) fn of(path: &Path, begin: &[u8]) -> Self {
        if is_recording(begin) {
            Self::Recording
        } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("bin")) {
            Self::Raw
        } else {
            Self::Csv
        }
    }
}

type Items = Box<dyn Iterator<Item = Result<Item, ReadError>>>;

enum Rows {
    Csv(Box<CsvRows>),
    Recorded(Box<RecordedRows<Items>>, Arc<AtomicU64>),
}

impl SessionReader {
    /// Opens a session, finds its columns and reads the first rows.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header and the first rows.
    pub fn open(path: &Path, needs: &Needs) -> Result<Self, SessionError> {
        let fail = |problem| SessionError { path: path.to_owned(), line: None, column: None, problem };
        let unreadable = |error| fail(Problem::Read(error));
        let mut file = File::open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        if metadata.is_dir() {
            return Err(fail(Problem::Directory));
        }
        let is_regular_file = metadata.is_file();
        let mut begin = Vec::new();
        file.by_ref().take(BEGIN).read_to_end(&mut begin).map_err(unreadable)?;
        let kind = Kind::of(path, &begin);
        let ends_with_line = kind != Kind::Csv || !is_regular_file || ends_with_line(&mut file).map_err(unreadable)?;
        // A pipe cannot go back.
        let source: Box<dyn Read> = if is_regular_file {
            file.rewind().map_err(unreadable)?;
            Box::new(file)
        } else {
            Box::new(Cursor::new(begin).chain(file))
        };
        let segments = needs.bend.len();
        if kind != Kind::Csv && segments > SEGMENTS {
            return Err(fail(Problem::RecordedSegments(segments)));
        }
        let position = Arc::new(AtomicU64::new(0));
        let counted = |source| BufReader::with_capacity(1 << 16, Counted { source, position: Arc::clone(&position) });
        let recorded = |items| Rows::Recorded(Box::new(RecordedRows::new(items)), Arc::clone(&position));
        let rows = match kind {
            Kind::Csv => Rows::Csv(Box::new(CsvRows::new(path, source, needs)?)),
            Kind::Recording => recorded(Box::new(Reader::new(counted(source))) as Items),
            Kind::Raw => recorded(Box::new(RawReader::new(counted(source))) as Items),
        };
        let mut reader = Self {
            path: path.to_owned(),
            size_bytes: metadata.len(),
            bend_sensors: match &rows {
                Rows::Csv(csv) => csv.bend_sensors(),
                Rows::Recorded(..) => vec![[false; 2]; segments],
            },
            rows,
            ahead: VecDeque::new(),
            rate_hz: None,
            ends_with_line,
            is_regular_file,
            kind,
        };
        reader.look_ahead(needs)?;
        Ok(reader)
    }

    fn look_ahead(&mut self, needs: &Needs) -> Result<(), SessionError> {
        while self.ahead.len() < RATE_ROWS {
            let Some(row) = self.read_row()? else { break };
            self.ahead.push_back(row);
        }
        if self.ahead.is_empty() {
            return Err(self.error(Problem::NoSamples));
        }
        let times = self.ahead.iter().map(|row| row.sample.time_us);
        self.rate_hz = rate_hz(times.clone().zip(times.skip(1)).map(|(from, to)| to - from).collect());
        if matches!(self.rows, Rows::Recorded(..)) {
            // A board has no columns: the sensors are those that it has read at all.
            for (i, present) in self.bend_sensors.iter_mut().enumerate() {
                let reads = |place: usize| self.ahead.iter().any(|row| row.sample.bend[i][place].is_some());
                *present = [reads(0), reads(1)];
            }
            if needs.truth && !self.has_truth() {
                return Err(self.error(Problem::NoTruth));
            }
        }
        Ok(())
    }

    /// What the file is.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Whether there is truth in the first rows.
    #[must_use]
    pub fn has_truth(&self) -> bool {
        self.ahead.iter().any(|row| row.truth.iter().any(Option::is_some))
    }

    /// Segments from the base to the last one of which a sensor was read, or the truth seen, in the first rows.
    #[must_use]
    pub fn segments_read(&self) -> usize {
        let is_read = |i: &usize| {
            self.ahead.iter().any(|Row { sample, truth, .. }| {
                sample.bend[*i].iter().any(Option::is_some) || sample.imu[*i].is_some() || truth[*i].is_some()
            })
        };
        (0..self.bend_sensors.len()).rev().find(is_read).map_or(0, |last| last + 1)
    }

    /// Sample rate: that of the mean step of the first rows without gaps, for jitter and rounded time stamps; where an
    /// arm's `usual_hz`, or up to ten times more or less, is within 1 % of it, that; and `usual_hz` where a single row
    /// does not tell.
    #[must_use]
    pub fn rate_hz(&self, usual_hz: f64) -> f64 {
        let Some(rate_hz) = self.rate_hz else { return usual_hz };
        let ratio = rate_hz / usual_hz;
        let nominal_hz =
            if ratio >= 1.0 { usual_hz * ratio.round().min(10.0) } else { usual_hz / ratio.recip().round().min(10.0) };
        if (rate_hz / nominal_hz - 1.0).abs() < 0.01 { nominal_hz } else { rate_hz }
    }

    /// Whether the session can be read twice, which a pipe cannot.
    #[must_use]
    pub fn is_regular_file(&self) -> bool {
        self.is_regular_file
    }

    /// Which bend sensors of each segment the session has.
    pub fn bend_sensors(&self) -> impl Iterator<Item = [bool; 2]> {
        self.bend_sensors.iter().copied()
    }

    /// Whether the last line is ended; if not, its last number may have been cut.
    #[must_use]
    pub fn ends_with_line(&self) -> bool {
        self.ends_with_line
    }

    /// How far the file was read, and its size, in bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        let position = match &self.rows {
            Rows::Csv(csv) => csv.position(),
            Rows::Recorded(_, position) => position.load(Ordering::Relaxed),
        };
        (position, self.size_bytes)
    }

    /// Where it is from a board: its last `Hello` so far, if there was one.
    #[must_use]
    pub fn hello(&self) -> Option<&Hello> {
        match &self.rows {
            Rows::Csv(_) => None,
            Rows::Recorded(rows, _) => rows.hello(),
        }
    }

    /// The next row, or `None` at the end.
    ///
    /// # Errors
    /// Any [`SessionError`] of a row.
    pub fn next_row(&mut self) -> Result<Option<Row>, SessionError> {
        match self.ahead.pop_front() {
            Some(row) => Ok(Some(row)),
            None => self.read_row(),
        }
    }

    fn read_row(&mut self) -> Result<Option<Row>, SessionError> {
        let row = match &mut self.rows {
            Rows::Csv(csv) => return csv.next_row(),
            Rows::Recorded(rows, _) => rows.next_row(),
        };
        row.map_err(|error| self.error(Problem::Recording(error)))
    }

    fn error(&self, problem: Problem) -> SessionError {
        SessionError { path: self.path.clone(), line: None, column: None, problem }
    }
}

/// Counts what is read.
struct Counted {
    source: Box<dyn Read>,
    position: Arc<AtomicU64>,
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.position.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

/// Rate of the mean step, µs, of those that are not over twice the median: rows that were lost are no slower rate.
fn rate_hz(mut steps_us: Vec<u64>) -> Option<f64> {
    steps_us.sort_unstable();
    let median = *steps_us.get(steps_us.len() / 2)?;
    let without_gaps = steps_us.partition_point(|step| *step <= 2 * median);
    let sum = steps_us[..without_gaps].iter().sum::<u64>();
    (sum > 0).then(|| without_gaps as f64 * 1e6 / sum as f64)
}
