//! Reads a session row by row, in memory that does not grow with its length.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use telemetry::{Hello, protocol_2};

use crate::column_names::TIME;
use crate::csv_file::CsvFile;
use crate::csv_rows::CsvRows;
use crate::recording::{Item, RawReader, ReadError, Reader, RecordedRows};
use crate::source::{FileFormat, SessionFile};
use crate::time_unit::time_factor;
use crate::{FileDefects, Mark, RequiredColumns, Row, SessionError, SessionProblem};

/// Rows at the start by whose time stamps the sample rate is measured.
const RATE_ROWS: usize = 1001;
/// Fewest rows by whose rate the unit of their times is judged.
const UNIT_ROWS: usize = 10;

/// Reader of a session in any [`FileFormat`].
pub struct SessionReader {
    path: PathBuf,
    size_bytes: u64,
    rows: Rows,
    ahead: VecDeque<Row>,
    rate_hz: Option<f64>,
    /// Number of the rows by which it was measured.
    rate_rows: usize,
    is_regular_file: bool,
    bend_sensors: Vec<[bool; 2]>,
    kind: FileFormat,
}

type Items = Box<dyn Iterator<Item = Result<Item, ReadError>>>;

enum Rows {
    Csv(Box<CsvRows>),
    Recorded(Box<RecordedRows<Items>>, Arc<AtomicU64>),
}

impl Rows {
    fn new(source: SessionFile, needs: &RequiredColumns) -> Result<Self, SessionError> {
        if source.kind == FileFormat::Csv {
            return Ok(Self::Csv(Box::new(CsvRows::new(CsvFile::new(source)?, needs)?)));
        }
        let (rows, position) = recorded(source)?;
        Ok(Self::Recorded(Box::new(rows), position))
    }
}

/// The rows of a recording or of raw bytes, and the position in the file.
fn recorded(mut source: SessionFile) -> Result<(RecordedRows<Items>, Arc<AtomicU64>), SessionError> {
    let (kind, summary) = (source.kind, source.summary()?);
    let (bytes, position) = source.into_counted()?;
    let items: Items = if kind == FileFormat::Raw {
        Box::new(RawReader::new(bytes))
    } else {
        Box::new(Reader::with_summary(bytes, summary))
    };
    Ok((RecordedRows::new(items), position))
}

/// Segments of the arm in a recording or in raw bytes, by the first sample.
///
/// # Errors
/// Any [`SessionError`] until there, and [`SessionProblem::NoSamples`].
pub(crate) fn board_segments(source: SessionFile) -> Result<usize, SessionError> {
    let path = source.path.clone();
    let first = recorded(source)?.0.next_row();
    let segments = match first {
        Ok(Some(Row { board: Some(board), .. })) => Ok(board.segments),
        Ok(_) => Err(SessionProblem::NoSamples),
        Err(error) => Err(SessionProblem::Recording(error)),
    };
    segments.map_err(|problem| SessionError { path, line: None, column: None, problem })
}

impl SessionReader {
    /// Opens a session, finds its columns and reads the first rows.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header and the first rows.
    pub fn open(path: &Path, needs: &RequiredColumns) -> Result<Self, SessionError> {
        let source = SessionFile::open(path)?;
        let (kind, size_bytes, is_regular_file) = (source.kind, source.size_bytes, source.is_regular_file);
        let segments = needs.bend.len();
        let rows = Rows::new(source, needs)?;
        let bend_sensors = match &rows {
            Rows::Csv(csv) => csv.bend_sensors(),
            Rows::Recorded(..) => vec![[false; 2]; segments],
        };
        let mut reader = Self {
            path: path.to_owned(),
            size_bytes,
            rows,
            ahead: VecDeque::new(),
            rate_hz: None,
            rate_rows: 0,
            is_regular_file,
            bend_sensors,
            kind,
        };
        reader.look_ahead(needs)?;
        Ok(reader)
    }

    fn look_ahead(&mut self, needs: &RequiredColumns) -> Result<(), SessionError> {
        while self.ahead.len() < RATE_ROWS {
            let Some(row) = self.read_row()? else { break };
            self.ahead.push_back(row);
        }
        if self.ahead.is_empty() {
            return Err(self.error(SessionProblem::NoSamples));
        }
        let steps = self.ahead.iter().zip(self.ahead.iter().skip(1)).map(|(from, to)| Step::new(from, to));
        self.rate_hz = rate_hz(steps.collect());
        self.rate_rows = self.ahead.len();
        if matches!(self.rows, Rows::Recorded(..)) {
            let board = self.ahead.iter().filter_map(|row| Some(row.board.as_ref()?.segments)).max().unwrap_or(0);
            // A board of protocol 2 has six segments in its messages for every arm.
            let is_of_arm = self.hello().is_some_and(|hello| hello.protocol > protocol_2::VERSION);
            if needs.bend.len() > board || (is_of_arm && needs.bend.len() < board) {
                let problem = SessionProblem::RecordedSegments { board, arm: needs.bend.len() };
                return Err(self.error(problem));
            }
            // A recording has no columns: the sensors are those with any reading.
            for (i, present) in self.bend_sensors.iter_mut().enumerate() {
                let reads = |place: usize| self.ahead.iter().any(|row| row.sample.bend[i][place].is_some());
                *present = [reads(0), reads(1)];
            }
            if needs.truth && !self.has_true_headings() {
                return Err(self.error(SessionProblem::NoTruth));
            }
        }
        Ok(())
    }

    /// Format of the file.
    #[must_use]
    pub fn kind(&self) -> FileFormat {
        self.kind
    }

    /// True where there is truth in the first rows.
    #[must_use]
    pub fn has_truth(&self) -> bool {
        self.ahead.iter().any(|row| row.truth.iter().any(Option::is_some))
    }

    /// True where that truth has headings.
    #[must_use]
    pub fn has_true_headings(&self) -> bool {
        self.ahead.iter().any(|row| row.truth.iter().flatten().any(|end| end.heading_rad.is_some()))
    }

    /// The first column of truth in a CSV, if there is any.
    #[must_use]
    pub fn truth_column(&self) -> Option<&str> {
        match &self.rows {
            Rows::Csv(csv) => csv.truth_column(),
            Rows::Recorded(..) => None,
        }
    }

    /// Segments of the arm of a board that has sent their number. Of other sessions those from the base to the last one of which
    /// a sensor was read, or the truth seen, in the first rows: every board of protocol 2 has sent readings of six segments.
    #[must_use]
    pub fn segments(&self) -> usize {
        if let Some(hello) = self.hello().filter(|hello| hello.protocol > protocol_2::VERSION) {
            return self.bend_sensors.len().min(hello.segments.into());
        }
        let is_read = |i: &usize| {
            self.ahead.iter().any(|Row { sample, truth, .. }| {
                sample.bend[*i].iter().any(Option::is_some) || sample.imu[*i].is_some() || truth[*i].is_some()
            })
        };
        (0..self.bend_sensors.len()).rev().find(is_read).map_or(0, |last| last + 1)
    }

    /// Sample rate, Hz: from the mean step of the first rows without gaps, as time stamps have jitter and are rounded. Where an
    /// arm's `usual_hz`, or up to ten times more or less, is within 1 % of it, that is used; with a single row `usual_hz`.
    ///
    /// # Errors
    /// [`SessionProblem::TimeUnit`] of a CSV whose times are not in seconds, by `usual_hz`.
    pub fn rate_hz(&self, usual_hz: f64) -> Result<f64, SessionError> {
        let Some(rate_hz) = self.rate_hz else { return Ok(usual_hz) };
        if self.kind == FileFormat::Csv
            && self.rate_rows >= UNIT_ROWS
            && let Some(factor) = time_factor(usual_hz, rate_hz)
        {
            let problem = SessionProblem::TimeUnit { rate_hz, usual_hz, factor };
            return Err(SessionError { column: Some(TIME.to_owned()), ..self.error(problem) });
        }
        let ratio = rate_hz / usual_hz;
        let nominal_hz =
            if ratio >= 1.0 { usual_hz * ratio.round().min(10.0) } else { usual_hz / ratio.recip().round().min(10.0) };
        Ok(if (rate_hz / nominal_hz - 1.0).abs() < 0.01 { nominal_hz } else { rate_hz })
    }

    /// True where the session can be read twice, which a pipe cannot.
    #[must_use]
    pub fn is_regular_file(&self) -> bool {
        self.is_regular_file
    }

    /// Presence of the bend sensors of each segment.
    pub fn bend_sensors(&self) -> impl Iterator<Item = [bool; 2]> {
        self.bend_sensors.iter().copied()
    }

    /// The file's defects in the rows that were read so far.
    #[must_use]
    pub fn defects(&self) -> FileDefects {
        match &self.rows {
            Rows::Csv(csv) => FileDefects { last_line_is_open: !csv.ends_with_line(), holes: Vec::new() },
            Rows::Recorded(rows, _) => FileDefects { last_line_is_open: false, holes: rows.holes().to_vec() },
        }
    }

    /// Position in the file and its size, bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        let position = match &self.rows {
            Rows::Csv(csv) => csv.position(),
            Rows::Recorded(_, position) => position.load(Ordering::Relaxed),
        };
        (position, self.size_bytes)
    }

    /// The board's last `Hello` so far; `None` in a CSV.
    #[must_use]
    pub fn hello(&self) -> Option<&Hello> {
        match &self.rows {
            Rows::Csv(_) => None,
            Rows::Recorded(rows, _) => rows.hello(),
        }
    }

    /// The marks that were read so far.
    #[must_use]
    pub fn marks(&self) -> &[Mark] {
        match &self.rows {
            Rows::Csv(_) => &[],
            Rows::Recorded(rows, _) => rows.marks(),
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
        row.map_err(|error| self.error(SessionProblem::Recording(error)))
    }

    fn error(&self, problem: SessionProblem) -> SessionError {
        SessionError { path: self.path.clone(), line: None, column: None, problem }
    }
}

/// Step from one row to the next.
struct Step {
    us: u64,
    /// Ticks of a recording; 1 in a CSV, which has no ticks.
    ticks: u32,
}

impl Step {
    fn new(from: &Row, to: &Row) -> Self {
        let boards = from.board.as_ref().zip(to.board.as_ref());
        let ticks = boards.map_or(1, |(from, to)| to.tick.wrapping_sub(from.tick));
        Self { us: to.sample.time_us - from.sample.time_us, ticks }
    }
}

/// Rate of the mean step, Hz. Steps over more ticks than usual or over twice the median are left out: lost rows do not lower
/// the rate.
fn rate_hz(mut steps: Vec<Step>) -> Option<f64> {
    steps.sort_unstable_by_key(|step| step.ticks);
    let usual = steps.get(steps.len() / 2)?.ticks;
    steps.truncate(steps.partition_point(|step| step.ticks <= usual));
    steps.sort_unstable_by_key(|step| step.us);
    let median_us = steps.get(steps.len() / 2)?.us;
    steps.truncate(steps.partition_point(|step| step.us <= 2 * median_us));
    let sum_us = steps.iter().map(|step| step.us).sum::<u64>();
    (sum_us > 0).then(|| steps.len() as f64 * 1e6 / sum_us as f64)
}
