//! Errors of a session: the problem and its place in the file.

use std::fmt;
use std::path::PathBuf;

use board_table::MAX_FULL_SCALE_PA;
use telemetry::{MAX_REGULATORS, MAX_SEGMENTS};

use crate::foreign_file::ForeignFile;
use crate::line_limit::LONGEST_LINE;
use crate::missing_column::MissingColumn;
use crate::motion_capture::MotionCaptureProblem;
use crate::recording::ReadError;
use crate::time_unit::time_unit_of;

/// A problem of a session, with its place in the file.
#[derive(Debug)]
pub struct SessionError {
    /// The file.
    pub path: PathBuf,
    /// Line in it, from 1.
    pub line: Option<u64>,
    /// Name of the column.
    pub column: Option<String>,
    /// The problem.
    pub problem: SessionProblem,
}

/// A problem of a session.
#[derive(Debug, thiserror::Error)]
pub enum SessionProblem {
    /// It cannot be opened or read.
    #[error("cannot be read: {0}")]
    Read(std::io::Error),
    /// It is a directory.
    #[error("is a directory, expected a session file")]
    Directory,
    /// It has no header.
    #[error("is empty, expected a header line")]
    NoHeader,
    /// It has a header and no more.
    #[error("has no samples, expected a row for each sample below the header")]
    NoSamples,
    /// A line that no session has.
    #[error("the line is longer than {most} kB", most = LONGEST_LINE / 1024)]
    LongLine,
    /// It is of another kind.
    #[error("{0}")]
    Foreign(ForeignFile),
    /// It is not UTF-8 text.
    #[error("is not UTF-8 text")]
    NotText,
    /// A column is missing.
    #[error("{0}")]
    MissingColumn(Box<MissingColumn>),
    /// A column is there twice.
    #[error("column {0} is there twice")]
    DuplicateColumn(String),
    /// A column belongs to a segment that the arm does not have.
    #[error("column {column} is of segment {segment}, but the arm has {segments}")]
    OtherArm {
        /// Name of the column.
        column: String,
        /// The column's segment.
        segment: usize,
        /// Segments of the arm.
        segments: usize,
    },
    /// A session that is to get truth has some.
    #[error("{0} is there already, expected a session without truth")]
    HasTruth(String),
    /// A row has too few or too many cells.
    #[error("the row has {found} cells, the header {expected}")]
    RowLength {
        /// Cells of the row.
        found: u64,
        /// Columns of the header.
        expected: u64,
    },
    /// A cell that needs a value is empty.
    #[error("the cell is empty, expected a time")]
    NoTime,
    /// A cell is not a number.
    #[error("\"{0}\" is not a number")]
    NotANumber(String),
    /// A cell is NaN or infinite.
    #[error("{0} is not finite; a missing reading is an empty cell")]
    NotFinite(String),
    /// ADC counts that a 12-bit converter cannot give.
    #[error("{0} counts, expected a whole number from 0 to 4095")]
    Counts(String),
    /// A tare's number that is not a whole number.
    #[error("tare {0}, expected a whole number that changes where the arm was tared")]
    Tare(String),
    /// A heading out of range.
    #[error("heading {0}, expected at least 0 and less than a turn")]
    Heading(String),
    /// Truth that no arm has.
    #[error("{0} is out of range, expected at most 100 km or 16 000 turns")]
    Truth(String),
    /// A session that would have to be read twice.
    #[error("is a pipe or device, expected a file, as it is read twice")]
    NotAFile,
    /// A time that does not fit.
    #[error("time {0} s, expected 0 s to 100 years")]
    Time(String),
    /// The times are not in seconds.
    #[error(
        "the rows are at {rate_hz:.4} Hz and the arm's are at {usual_hz} Hz: the times are {factor:.4} times too large{}",
        unit(*.factor)
    )]
    TimeUnit {
        /// Rate of the session's rows by their times, Hz.
        rate_hz: f64,
        /// Rate in the table or the arm description, Hz.
        usual_hz: f64,
        /// Factor by which the times are too large.
        factor: f64,
    },
    /// A camera's time that does not fit.
    #[error("time {0} s, expected one within 100 years of 0")]
    Clock(String),
    /// A pressure is missing.
    #[error("the cell is empty, expected a pressure")]
    NoPressure,
    /// A pressure that no regulator gives.
    #[error("pressure {0}, expected 0 to {most} kPa", most = MAX_FULL_SCALE_PA / 1000)]
    Pressure(String),
    /// Pressures of more regulators than a board has.
    #[error("has pressures of {0} regulators, a board has {MAX_REGULATORS} at most")]
    TooManyRegulators(usize),
    /// A profile has a header and no more.
    #[error("has no pressures, expected a row for each point below the header")]
    NoMoments,
    /// Time goes backwards.
    #[error("time goes backwards, from {from_s} s to {to_s} s")]
    Backwards {
        /// Time of the row before.
        from_s: f64,
        /// Time of this row.
        to_s: f64,
    },
    /// A problem of a motion-capture program's export.
    #[error(transparent)]
    MotionCapture(Box<MotionCaptureProblem>),
    /// A recording that cannot be read.
    #[error(transparent)]
    Recording(ReadError),
    /// A recording of which nothing can be recovered.
    #[error("nothing in it is whole: no message can be read")]
    NothingWhole,
    /// A recording of a board with another number of segments than the arm.
    #[error("is a recording of a board with {board} segments, the arm has {arm}")]
    RecordedSegments {
        /// Segments of the board's arm.
        board: usize,
        /// Segments of the arm.
        arm: usize,
    },
    /// More segments than a board has.
    #[error("has {0} segments, a board and its recordings have {MAX_SEGMENTS} at most")]
    TooManySegments(usize),
    /// A recording without the truth that is needed.
    #[error("has no truth in its first samples")]
    NoTruth,
    /// A quaternion of which only some parts are there.
    #[error("the quaternion has an empty part, expected all four or none")]
    PartialQuaternion,
    /// A quaternion that is no orientation.
    #[error("the quaternion's norm is {0:.4}, expected 1 within 1 %")]
    NotUnit(f64),
    /// A pose of which only some parts are there.
    #[error("the truth has an empty part, expected all of its cells or none")]
    PartialTruth,
}

fn unit(factor: f64) -> String {
    time_unit_of(factor).map_or_else(String::new, |(_, name)| format!(", as {name} are"))
}

impl fmt::Display for SessionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", column {column}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

impl std::error::Error for SessionError {}
