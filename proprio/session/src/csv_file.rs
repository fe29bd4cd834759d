//! A CSV file: its header and its rows, and errors that name the file, the line and the column.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use crate::columns::{Column, TruthColumns};
use crate::foreign_file::ForeignFile;
use crate::line_limit::{LineLimit, LongLine};
use crate::source::SessionFile;
use crate::{FileFormat, Pose, SessionError, SessionProblem, Truth, cell};

/// A CSV file that is being read, at one of its rows.
pub(crate) struct CsvFile {
    path: PathBuf,
    size_bytes: u64,
    names: Vec<String>,
    csv: csv::Reader<LineLimit<Box<dyn Read>>>,
    record: StringRecord,
    ends_with_line: bool,
}

impl CsvFile {
    /// Reads the header.
    pub fn new(mut source: SessionFile) -> Result<Self, SessionError> {
        if source.kind != FileFormat::Csv {
            return Err(source.error(SessionProblem::Foreign(ForeignFile::Recording)));
        }
        let (path, size_bytes, ends_with_line) = (source.path.clone(), source.size_bytes, source.ends_with_line()?);
        let mut csv =
            csv::ReaderBuilder::new().buffer_capacity(1 << 16).from_reader(LineLimit::new(source.into_bytes()?));
        let header = csv.headers().map_err(|error| csv_error(&path, error))?;
        let names: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        let has_header = !header.iter().all(str::is_empty);
        let file = Self { path, size_bytes, names, csv, record: StringRecord::new(), ends_with_line };
        if has_header { Ok(file) } else { Err(file.error(SessionProblem::NoHeader)) }
    }

    /// Names of the columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    pub fn ends_with_line(&self) -> bool {
        self.ends_with_line
    }

    /// Position in the file and its size, bytes.
    pub fn progress(&self) -> (u64, u64) {
        (self.csv.position().byte(), self.size_bytes)
    }

    /// Goes to the next row; false at the end.
    pub fn advance(&mut self) -> Result<bool, SessionError> {
        self.csv.read_record(&mut self.record).map_err(|error| csv_error(&self.path, error))
    }

    /// A cell of this row, parsed by `parse`.
    pub fn cell<T>(&self, index: usize, parse: impl Fn(&str) -> Result<T, SessionProblem>) -> Result<T, SessionError> {
        parse(self.record.get(index).unwrap_or_default()).map_err(|problem| self.cell_error(index, problem))
    }

    /// A pose: x, y and heading, or none of them.
    pub fn pose(&self, columns: [Column; 3]) -> Result<Option<Pose>, SessionError> {
        let truth = self.truth(columns.into())?;
        Ok(truth.and_then(|Truth { x_m, y_m, heading_rad }| Some(Pose { x_m, y_m, heading_rad: heading_rad? })))
    }

    /// A true place, with its heading where there is a column for it, or nothing of them.
    pub fn truth(&self, columns: TruthColumns) -> Result<Option<Truth>, SessionError> {
        let value = |Column { index, factor }: Column| self.cell(index, |text| cell::truth(text, factor));
        let TruthColumns { x, y, heading } = columns;
        let parts = [value(x)?, value(y)?, heading.map_or(Ok(None), value)?];
        match parts {
            [None, None, None] => Ok(None),
            [Some(x_m), Some(y_m), heading_rad] if heading_rad.is_some() == heading.is_some() => {
                Ok(Some(Truth { x_m, y_m, heading_rad }))
            }
            _ => {
                let columns = [x, y, heading.unwrap_or(x)];
                Err(self.cell_error(columns[first_empty(&parts)].index, SessionProblem::PartialTruth))
            }
        }
    }

    /// A problem of a cell of this row.
    pub fn cell_error(&self, index: usize, problem: SessionProblem) -> SessionError {
        let line = self.record.position().map(|position| line_at(&self.path, position));
        SessionError { path: self.path.clone(), line, column: self.names.get(index).cloned(), problem }
    }

    /// A problem of the header.
    pub fn header_error(&self, problem: SessionProblem) -> SessionError {
        SessionError { line: Some(1), ..self.error(problem) }
    }

    /// A problem of the whole file.
    pub fn error(&self, problem: SessionProblem) -> SessionError {
        SessionError { path: self.path.clone(), line: None, column: None, problem }
    }
}

/// The part to name: the first that is empty, else the first.
pub(crate) fn first_empty(parts: &[Option<f64>]) -> usize {
    parts.iter().position(Option::is_none).unwrap_or(0)
}

/// Line of a row, from 1. The parser counts a line end only when it reads on, which the `\r\n` and the empty lines
/// before a row mislead; so the file is looked at again, where it can be: a pipe is gone once it is read.
pub(crate) fn line_at(path: &Path, row: &csv::Position) -> u64 {
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

pub(crate) fn csv_error(path: &Path, error: csv::Error) -> SessionError {
    let mut line = error.position().map(|position| line_at(path, position));
    let problem = match error.into_kind() {
        csv::ErrorKind::Io(error) => {
            let long = error.get_ref().and_then(|error| error.downcast_ref::<LongLine>());
            line = long.map(|long| long.line);
            if long.is_some() { SessionProblem::LongLine } else { SessionProblem::Read(error) }
        }
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            SessionProblem::RowLength { found: len, expected: expected_len }
        }
        _ => SessionProblem::NotText,
    };
    SessionError { path: path.to_owned(), line, column: None, problem }
}
