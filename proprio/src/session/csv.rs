//! A session as CSV, row by row.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use calibration_tables::MAX_SEGMENTS;
use csv::StringRecord;
use estimator_core::{ImuReading, Sample};

use super::columns::{Column, Columns, ImuColumn};
use super::{Needs, Pose, Problem, Row, SessionError, cell};

/// The rows of a CSV file.
pub(super) struct CsvRows {
    path: PathBuf,
    names: Vec<String>,
    columns: Columns,
    csv: csv::Reader<Box<dyn Read>>,
    record: StringRecord,
    last_time_us: u64,
    has_started: bool,
    last_tare: Option<u64>,
}

impl CsvRows {
    /// Reads the header and finds the columns.
    pub fn new(path: &Path, source: Box<dyn Read>, needs: &Needs) -> Result<Self, SessionError> {
        let fail = |line, problem| SessionError { path: path.to_owned(), line, column: None, problem };
        let mut csv = csv::ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(source);
        let header = csv.headers().map_err(|error| csv_error(path, error))?;
        if header.iter().all(str::is_empty) {
            return Err(fail(None, Problem::NoHeader));
        }
        let names: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        let columns = Columns::find(&names, needs).map_err(|problem| fail(Some(1), problem))?;
        let path = path.to_owned();
        Ok(Self {
            path,
            names,
            columns,
            csv,
            record: StringRecord::new(),
            last_time_us: 0,
            has_started: false,
            last_tare: None,
        })
    }

    /// Which bend sensors of each segment it has.
    pub fn bend_sensors(&self) -> Vec<[bool; 2]> {
        self.columns.segments.iter().map(|segment| segment.bend.map(|column| column.is_some())).collect()
    }

    /// How far the file was read, in bytes.
    pub fn position(&self) -> u64 {
        self.csv.position().byte()
    }

    /// The next row, or `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Row>, SessionError> {
        if !self.csv.read_record(&mut self.record).map_err(|error| csv_error(&self.path, error))? {
            return Ok(None);
        }
        let time_us = self.cell(self.columns.time, cell::time_us)?;
        if time_us < self.last_time_us {
            let (from_s, to_s) = (self.last_time_us as f64 / 1e6, time_us as f64 / 1e6);
            return Err(self.cell_error(self.columns.time, Problem::Backwards { from_s, to_s }));
        }
        self.last_time_us = time_us;
        let tare = self.columns.tare.map_or(Ok(None), |column| self.cell(column, cell::tare))?;
        let starts = !std::mem::replace(&mut self.has_started, true) || tare != self.last_tare;
        self.last_tare = tare;
        let mut row = Row { sample: Sample::missing(time_us), truth: [None; MAX_SEGMENTS], starts, board: None };
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

    fn pose(&self, columns: [Column; 3]) -> Result<Option<Pose>, SessionError> {
        let value = |Column { index, factor }| self.cell(index, |text| cell::truth(text, factor));
        let [x, y, heading] = columns.map(value);
        let parts = [x?, y?, heading?];
        match parts {
            [None, None, None] => Ok(None),
            [Some(x_m), Some(y_m), Some(heading_rad)] => Ok(Some(Pose { x_m, y_m, heading_rad })),
            _ => Err(self.cell_error(columns[first_empty(&parts)].index, Problem::PartialTruth)),
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

/// The part to name: the first that is empty, else the first.
fn first_empty(parts: &[Option<f64>]) -> usize {
    parts.iter().position(Option::is_none).unwrap_or(0)
}

/// Looks at the last byte, and goes back to the first.
pub(super) fn ends_with_line(file: &mut File) -> io::Result<bool> {
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
