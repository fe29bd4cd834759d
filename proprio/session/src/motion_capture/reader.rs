//! Reads the frames of an export.

use std::io::Read;
use std::path::PathBuf;

use csv::StringRecord;

use super::axis::Axis;
use super::error::MotionCaptureProblem;
use super::layout::{Body, Layout, TimeColumn, cell as text_of};
use super::selection::BodySelection;
use super::{motive, qualisys, vicon};
use crate::csv_file::{csv_error, line_at};
use crate::line_limit::LineLimit;
use crate::shown::shown;
use crate::source::SessionFile;
use crate::{FileDefects, Pose, SessionError, SessionProblem, cell};

/// Rows of the longest header.
const LONGEST_HEADER: usize = 64;

/// The program of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Program {
    Motive,
    Vicon,
    Qualisys,
}

impl Program {
    /// The program of an export by its first bytes; `None` for other files.
    fn of(begin: &[u8]) -> Option<Self> {
        let text = begin.strip_prefix(b"\xef\xbb\xbf").unwrap_or(begin);
        let first = text.split(|byte| matches!(byte, b',' | b'\t' | b'\r' | b'\n')).next().unwrap_or_default();
        if first == motive::BEGIN.as_bytes() {
            Some(Self::Motive)
        } else if first == qualisys::BEGIN.as_bytes() {
            Some(Self::Qualisys)
        } else {
            vicon::SECTIONS.iter().any(|section| first == section.as_bytes()).then_some(Self::Vicon)
        }
    }

    const fn delimiter(self) -> u8 {
        match self {
            Self::Qualisys => b'\t',
            Self::Motive | Self::Vicon => b',',
        }
    }
}

/// One frame of an export.
pub struct BodyFrame {
    /// Time by the program's clock, s.
    pub time_s: f64,
    /// The bodies' poses in the arm's plane, in the order of the selection; `None` where a body was not seen. Headings are those
    /// of the bodies' own axes.
    pub poses: Vec<Option<Pose>>,
}

/// Reader of an export's frames.
pub struct MotionCaptureReader {
    path: PathBuf,
    size_bytes: u64,
    ends_with_line: bool,
    rows: csv::Reader<LineLimit<Box<dyn Read>>>,
    record: StringRecord,
    layout: Layout,
    up: Axis,
    last_time_s: f64,
}

impl MotionCaptureReader {
    /// True for the export of a motion-capture program, by its first bytes.
    pub(crate) fn is_export(source: &SessionFile) -> bool {
        Program::of(source.begin()).is_some()
    }

    /// Reads the header of an export, for an arm of `segments` segments.
    pub(crate) fn new(
        mut source: SessionFile,
        segments: usize,
        selection: &BodySelection,
    ) -> Result<Self, SessionError> {
        let path = source.path.clone();
        let fail = |problem: MotionCaptureProblem| SessionError {
            path: path.clone(),
            line: Some(1),
            column: None,
            problem: SessionProblem::MotionCapture(Box::new(problem)),
        };
        let program = Program::of(source.begin()).ok_or_else(|| fail(MotionCaptureProblem::NotAnExport))?;
        let (size_bytes, ends_with_line) = (source.size_bytes, source.ends_with_line()?);
        let mut rows = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(program.delimiter())
            .from_reader(LineLimit::new(source.into_bytes()?));
        let layout = header(program, &mut rows).map_err(|error| match error {
            HeaderError::Csv(error) => csv_error(&path, error),
            HeaderError::Export(problem) => fail(problem),
        })?;
        let layout = layout.select(&selection.names, segments).map_err(fail)?;
        let up = selection.up.unwrap_or(layout.up);
        let (record, last_time_s) = (StringRecord::new(), f64::NEG_INFINITY);
        Ok(Self { path, size_bytes, ends_with_line, rows, record, layout, up, last_time_s })
    }

    /// Names of the bodies that are read, from the base to the tip.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = &str> {
        self.layout.bodies.iter().map(|body| body.name.as_str())
    }

    /// The file's defects.
    pub(crate) fn defects(&self) -> FileDefects {
        FileDefects { last_line_is_open: !self.ends_with_line, holes: Vec::new() }
    }

    /// Position in the file and its size, bytes.
    pub(crate) fn progress(&self) -> (u64, u64) {
        (self.rows.position().byte(), self.size_bytes)
    }

    /// The next frame.
    pub(crate) fn next_frame(&mut self) -> Result<Option<BodyFrame>, SessionError> {
        loop {
            if !self.rows.read_record(&mut self.record).map_err(|error| csv_error(&self.path, error))? {
                return Ok(None);
            }
            let first = text_of(&self.record, 0);
            if first.parse::<f64>().is_ok() {
                break;
            }
            // Another section of Vicon's.
            if vicon::SECTIONS.contains(&first) {
                return Ok(None);
            }
            if !first.is_empty() {
                return Err(self.cell_error(0, SessionProblem::NotANumber(shown(first))));
            }
        }
        let time_s = match self.layout.time {
            TimeColumn::Seconds(column) => self.cell(column, cell::clock_s)?,
            TimeColumn::Frames { column, rate_hz } => self.cell(column, cell::clock_s)? / rate_hz,
        };
        if time_s < self.last_time_s {
            return Err(self.cell_error(0, SessionProblem::Backwards { from_s: self.last_time_s, to_s: time_s }));
        }
        self.last_time_s = time_s;
        let poses = self.layout.bodies.iter().map(|body| self.pose(body)).collect::<Result<_, _>>()?;
        Ok(Some(BodyFrame { time_s, poses }))
    }

    /// A body's pose; `None` where it has empty cells, or zeros for its place, by which lost bodies are exported too.
    fn pose(&self, body: &Body) -> Result<Option<Pose>, SessionError> {
        let [x, y, z] = body.position.map(|column| self.cell(column, |text| cell::truth(text, self.layout.metres)));
        let (Some(x), Some(y), Some(z)) = (x?, y?, z?) else { return Ok(None) };
        let number = |column| self.cell(column, cell::number);
        let Some(twist) = body.rotation.twist(self.up, number)? else { return Ok(None) };
        if [x, y, z].iter().all(|part| *part == 0.0) {
            return Ok(None);
        }
        let [x_m, y_m] = self.up.in_plane([x, y, z]);
        Ok(Some(Pose { x_m, y_m, heading_rad: -twist }))
    }

    fn cell<T>(&self, column: usize, parse: impl Fn(&str) -> Result<T, SessionProblem>) -> Result<T, SessionError> {
        parse(text_of(&self.record, column)).map_err(|problem| self.cell_error(column, problem))
    }

    /// A problem of a cell, whose column is named by its number, as spreadsheets do from 1.
    fn cell_error(&self, column: usize, problem: SessionProblem) -> SessionError {
        let line = self.record.position().map(|position| line_at(&self.path, position));
        SessionError { path: self.path.clone(), line, column: Some((column + 1).to_string()), problem }
    }
}

/// A header that cannot be read.
enum HeaderError {
    Csv(csv::Error),
    Export(MotionCaptureProblem),
}

/// Reads the rows of a header.
fn header<R: Read>(program: Program, file: &mut csv::Reader<R>) -> Result<Layout, HeaderError> {
    let mut rows: Vec<StringRecord> = Vec::new();
    let mut row = StringRecord::new();
    while file.read_record(&mut row).map_err(HeaderError::Csv)? {
        // Rows of Vicon's sections before that of the bodies.
        if program == Program::Vicon && rows.is_empty() && !vicon::is_bodies(&row) {
            continue;
        }
        rows.push(row.clone());
        let (is_last, layout): (bool, fn(&[StringRecord]) -> _) = match program {
            Program::Motive => (motive::is_last(&row), motive::layout),
            Program::Vicon => (vicon::is_last(&rows), vicon::layout),
            Program::Qualisys => (qualisys::is_last(&row), qualisys::layout),
        };
        if is_last {
            return layout(&rows).map_err(HeaderError::Export);
        }
        if rows.len() == LONGEST_HEADER {
            break;
        }
    }
    let is_without = program == Program::Vicon && rows.is_empty();
    Err(HeaderError::Export(if is_without { MotionCaptureProblem::NoBodies } else { MotionCaptureProblem::Header }))
}
