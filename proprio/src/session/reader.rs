//! Reads a session row by row, in memory that does not grow with its length.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use calibration_tables::MAX_SEGMENTS;
use csv::StringRecord;
use estimator_core::{ImuReading, Sample};

use super::columns::{Column, Columns, ImuColumn, TruthColumns};
use super::{Needs, Pose, Problem, Row, SessionError, cell};

/// Rows at the start whose time stamps tell the sample rate.
const RATE_ROWS: usize = 1001;

/// A session that is being read.
pub struct SessionReader {
    path: PathBuf,
    size_bytes: u64,
    names: Vec<String>,
    columns: Columns,
    csv: csv::Reader<File>,
    record: StringRecord,
    last_time_us: u64,
    ahead: VecDeque<Row>,
    rate_hz: Option<f64>,
    ends_with_line: bool,
    is_regular_file: bool,
}

impl SessionReader {
    /// Opens a session, finds its columns and reads the first rows.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header and the first rows.
    pub fn open(path: &Path, needs: &Needs) -> Result<Self, SessionError> {
        let fail = |line, problem| SessionError { path: path.to_owned(), line, column: None, problem };
        let mut file = File::open(path).map_err(|error| fail(None, Problem::Read(error)))?;
        let metadata = file.metadata().map_err(|error| fail(None, Problem::Read(error)))?;
        if metadata.is_dir() {
            return Err(fail(None, Problem::Directory));
        }
        let is_regular_file = metadata.is_file();
        let ends_with_line =
            !is_regular_file || ends_with_line(&mut file).map_err(|error| fail(None, Problem::Read(error)))?;
        let mut csv = csv::ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(file);
        let header = csv.headers().map_err(|error| csv_error(path, error))?;
        if header.iter().all(str::is_empty) {
            return Err(fail(None, Problem::NoHeader));
        }
        let names: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        let columns = Columns::find(&names, needs).map_err(|problem| fail(Some(1), problem))?;
        let mut reader = Self {
            path: path.to_owned(),
            size_bytes: metadata.len(),
            names,
            columns,
            csv,
            record: StringRecord::new(),
            last_time_us: 0,
            ahead: VecDeque::new(),
            rate_hz: None,
            ends_with_line,
            is_regular_file,
        };
        reader.look_ahead()?;
        Ok(reader)
    }

    fn look_ahead(&mut self) -> Result<(), SessionError> {
        while self.ahead.len() < RATE_ROWS {
            let Some(row) = self.read_row()? else { break };
            self.ahead.push_back(row);
        }
        if self.ahead.is_empty() {
            return Err(self.error(None, None, Problem::NoSamples));
        }
        let times = self.ahead.iter().map(|row| row.sample.time_us);
        self.rate_hz = rate_hz(times.clone().zip(times.skip(1)).map(|(from, to)| to - from).collect());
        Ok(())
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
        self.columns.segments.iter().map(|segment| segment.bend.map(|column| column.is_some()))
    }

    /// Whether the last line is ended; if not, its last number may have been cut.
    #[must_use]
    pub fn ends_with_line(&self) -> bool {
        self.ends_with_line
    }

    /// How far the file was read, and its size, in bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        (self.csv.position().byte(), self.size_bytes)
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
        if !self.csv.read_record(&mut self.record).map_err(|error| csv_error(&self.path, error))? {
            return Ok(None);
        }
        let time_us = self.cell(self.columns.time, cell::time_us)?;
        if time_us < self.last_time_us {
            let (from_s, to_s) = (self.last_time_us as f64 / 1e6, time_us as f64 / 1e6);
            return Err(self.cell_error(self.columns.time, Problem::Backwards { from_s, to_s }));
        }
        self.last_time_us = time_us;
        let mut row = Row { sample: Sample::missing(time_us), truth: [None; MAX_SEGMENTS] };
        let sample = row.sample.bend.iter_mut().zip(&mut row.sample.imu).zip(&mut row.truth);
        for (segment, ((bend, imu), truth)) in self.columns.segments.iter().zip(sample) {
            for (counts, column) in bend.iter_mut().zip(segment.bend) {
                *counts = column.map_or(Ok(None), |column| self.cell(column, cell::counts))?;
            }
            *imu = self.imu(segment.imu)?;
            *truth = segment.truth.map_or(Ok(None), |columns| self.pose(columns))?;
        }
        Ok(Some(row))
    }

    fn imu(&self, column: ImuColumn) -> Result<Option<ImuReading>, SessionError> {
        match column {
            ImuColumn::Heading(Column { index, factor }) => self.cell(index, |text| cell::heading(text, factor)),
            ImuColumn::Quaternion(columns) => {
                let [w, x, y, z] = columns.map(|index| self.cell(index, cell::number));
                let parts = [w?, x?, y?, z?];
                cell::quaternion(parts).map_err(|problem| self.cell_error(columns[first_empty(&parts)], problem))
            }
        }
    }

    fn pose(&self, columns: TruthColumns) -> Result<Option<Pose>, SessionError> {
        let value = |Column { index, factor }: Column| self.cell(index, |text| cell::truth(text, factor));
        let TruthColumns { x, y, heading } = columns;
        let parts = [value(x)?, value(y)?, heading.map_or(Ok(None), value)?];
        match parts {
            [None, None, None] => Ok(None),
            [Some(x_m), Some(y_m), heading_rad] if heading_rad.is_some() == heading.is_some() => {
                Ok(Some(Pose { x_m, y_m, heading_rad }))
            }
            _ => {
                let empty =
                    [Some(x), Some(y), heading].into_iter().flatten().zip(parts).find(|(_, part)| part.is_none());
                Err(self.cell_error(empty.map_or(x.index, |(column, _)| column.index), Problem::PartialTruth))
            }
        }
    }

    fn cell<T>(&self, index: usize, parse: impl Fn(&str) -> Result<T, Problem>) -> Result<T, SessionError> {
        parse(self.record.get(index).unwrap_or_default()).map_err(|problem| self.cell_error(index, problem))
    }

    fn cell_error(&self, index: usize, problem: Problem) -> SessionError {
        let line = self.record.position().map(|position| line_at(&self.path, position));
        self.error(line, self.names.get(index).cloned(), problem)
    }

    fn error(&self, line: Option<u64>, column: Option<String>, problem: Problem) -> SessionError {
        SessionError { path: self.path.clone(), line, column, problem }
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

/// The part to name: the first that is empty, else the first.
fn first_empty(parts: &[Option<f64>]) -> usize {
    parts.iter().position(Option::is_none).unwrap_or(0)
}

/// Looks at the last byte, and goes back to the first.
fn ends_with_line(file: &mut File) -> io::Result<bool> {
    let mut last = [b'\n'];
    if file.seek(SeekFrom::End(-1)).is_ok() {
        file.read_exact(&mut last)?;
        file.rewind()?;
    }
    Ok(last == [b'\n'])
}

/// Line of a row, from 1. The parser counts a line end only when it reads on, which the `\r\n` and the empty lines
/// before a row mislead; so the file is looked at again, where it can be: a pipe is gone once it is read.
fn line_at(path: &Path, row: &csv::Position) -> u64 {
    if !path.is_file() {
        return row.line();
    }
    File::open(path).and_then(|file| lines_before(file, row.byte())).map_or(row.line(), |lines| lines + 1)
}

/// Line ends before a row that begins at `byte`, or behind the line ends there.
fn lines_before(file: File, byte: u64) -> io::Result<u64> {
    let mut lines = 0;
    for (place, next) in (0..).zip(BufReader::new(file).bytes()) {
        let next = next?;
        if place >= byte && !matches!(next, b'\r' | b'\n') {
            break;
        }
        lines += u64::from(next == b'\n');
    }
    Ok(lines)
}

fn csv_error(path: &Path, error: csv::Error) -> SessionError {
    let mut line = error.position().map(|position| line_at(path, position));
    let problem = match error.into_kind() {
        csv::ErrorKind::Io(error) => {
            line = None;
            Problem::Read(error)
        }
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            Problem::RowLength { found: len, expected: expected_len }
        }
        _ => Problem::NotText,
    };
    SessionError { path: path.to_owned(), line, column: None, problem }
}
