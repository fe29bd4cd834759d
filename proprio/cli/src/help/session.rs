//! Remedies of errors of sessions.

use proprio_session::recording::ReadError;
use proprio_session::{
    FileContent, ForeignFile, MissingColumn, MissingReason, MotionCaptureProblem, SessionProblem, time_unit_of,
};

use super::Help;

/// Times after which a clock of 32 bits wraps, s, and its unit.
const WRAPS: [(f64, &str); 2] = [(4_294.967_296, "microseconds"), (4_294_967.296, "milliseconds")];
/// Longest step from the last row before a wrap to the first one behind it, s.
const LONGEST_STEP_S: f64 = 60.0;
/// Largest step backwards of rows that are in another order, s.
const OUT_OF_ORDER_S: f64 = 2.0;
/// Latest time of the first row of a board that has restarted, s.
const AFTER_RESTART_S: f64 = 60.0;

impl Help for SessionProblem {
    fn help(&self) -> String {
        let help = match self {
            Self::Read(_) | Self::Recording(ReadError::Read(_)) => "check the name and that you may read it",
            Self::Directory => "name the .csv file in it",
            Self::NoHeader | Self::NoSamples | Self::NothingWhole => "record the session again, or take another",
            Self::LongLine => "end each row with a line end; is it a CSV? copy the file again, or take another",
            Self::Foreign(of) => foreign_file(*of),
            Self::NotText => "save it as CSV in UTF-8",
            Self::MissingColumn(missing) => return missing.help(),
            Self::TimeUnit { rate_hz, factor, .. } => return time_unit(*rate_hz, *factor),
            Self::Backwards { from_s, to_s } => return backwards(*from_s, *to_s),
            Self::DuplicateColumn(_) => "remove or rename one of them",
            Self::OtherArm { .. } | Self::RecordedSegments { .. } => {
                "take the arm description or table of the arm that was recorded"
            }
            Self::RowLength { .. } => {
                "the file was cut or edited, or has decimal commas: remove the row, copy the file again, or use points"
            }
            Self::HasTruth(_) => "take the session as it was recorded, or use it as it is: it is aligned",
            Self::NoTime | Self::Time(_) | Self::Clock(_) => "give every row its time in seconds",
            Self::NoPressure => "give every regulator its pressure in every row; 0 is vented",
            Self::Pressure(_) => "write pressures over the atmosphere's: in kPa in _kpa, in Pa in _pa",
            Self::TooManyRegulators(_) => "remove the columns of the regulators that the board does not have",
            Self::NoMoments => "give at least one row",
            Self::NotANumber(_) => "write numbers with a decimal point, and leave the cell of a missing reading empty",
            Self::NotFinite(_) => "leave the cell empty",
            Self::Counts(_) => "write raw ADC counts, and leave the cell of a missing reading empty",
            Self::Truth(_) => "correct the value, or leave all cells of this truth empty",
            Self::NotAFile => "save it as a file first",
            Self::Tare(_) => "write the number, or remove the column",
            Self::MotionCapture(problem) => return motion_capture(problem).to_owned(),
            Self::Recording(ReadError::Cut) => "recover its complete part with `proprio recover`",
            Self::Recording(ReadError::OtherForm(_) | ReadError::OtherProtocol(_)) => {
                "read it with the proprio of that version"
            }
            Self::Recording(ReadError::NoMcap) => {
                "only recordings (.mcap) are recovered; correct a CSV at the line that an error names"
            }
            Self::Recording(ReadError::Foreign(_)) => {
                "take a recording of `proprio record`, or make a CSV of this one's samples (docs/reference/files.md)"
            }
            Self::Recording(ReadError::Damaged(_)) => {
                "recover its complete part with `proprio recover`, or take another"
            }
            Self::TooManySegments(_) => "keep it as CSV",
            Self::NoTruth => "give a session with the camera's truth (docs/reference/files.md)",
            Self::Heading(_) => "write headings from 0 up to a full turn: 360 in _deg, 2π in _rad",
            Self::PartialQuaternion | Self::NotUnit(_) => {
                "write unit quaternions w, x, y, z, and leave all four cells of a missing reading empty"
            }
            Self::PartialTruth => "leave all its cells empty where the camera did not see the segment",
        };
        help.to_owned()
    }
}

/// Remedy of a motion-capture program's export.
const fn motion_capture(problem: &MotionCaptureProblem) -> &'static str {
    match problem {
        MotionCaptureProblem::Header => "export it again with its header and the names of the columns",
        MotionCaptureProblem::NoBodies => {
            "make a rigid body of the markers at each segment's end, and export positions and rotations: docs/reference/files.md"
        }
        MotionCaptureProblem::Unit(_) => "export m, cm or mm, and quaternions or degrees: docs/reference/files.md",
        MotionCaptureProblem::Count { .. } => "name the arm's bodies from the base to the tip with --bodies A,B,…",
        MotionCaptureProblem::Unknown { .. } | MotionCaptureProblem::Twice(_) => {
            "give the names of the file, one for each segment's end, the base before them"
        }
        MotionCaptureProblem::NotAnExport => "leave --bodies and --up out",
    }
}

/// Remedy of a file of another kind.
fn foreign_file(foreign: ForeignFile) -> &'static str {
    match foreign {
        ForeignFile::Packed(_) => "unpack it first",
        ForeignFile::Spreadsheet => "save it as CSV in UTF-8, with commas between the columns and decimal points",
        ForeignFile::Data(_) => "write its readings to a CSV: docs/reference/files.md",
        ForeignFile::Utf16 => "save it as UTF-8",
        ForeignFile::Recording => "give a CSV; that of a recording's samples is made with `proprio convert`",
    }
}

/// Remedy of times in another unit than seconds.
fn time_unit(rate_hz: f64, factor: f64) -> String {
    let change = match time_unit_of(factor) {
        Some((unit, _)) if unit < 1.0 => format!("multiply time_s by {:.0}", unit.recip()),
        Some((unit, _)) => format!("divide time_s by {unit:.0}"),
        None => "give time_s in seconds".to_owned(),
    };
    format!("{change}; or if it is in seconds, write rate_hz = {rate_hz:.4} in the table or arm description")
}

/// Remedy of time that goes backwards. Sorted rows of a clock that has wrapped would be a session in the wrong order.
fn backwards(from_s: f64, to_s: f64) -> String {
    let wrap = WRAPS.iter().find(|(wrap_s, _)| (0.0..LONGEST_STEP_S).contains(&(to_s + wrap_s - from_s)));
    match wrap {
        Some((wrap_s, unit)) => {
            format!("the clock's 32 bits of {unit} have wrapped: add {wrap_s} s from here on; do not sort")
        }
        None if from_s - to_s <= OUT_OF_ORDER_S => "rows are out of order: sort them by time".to_owned(),
        None if to_s <= AFTER_RESTART_S => {
            "the board or the logger has restarted: split the session here, as headings have a new zero; do not sort"
                .to_owned()
        }
        None => "the clock was set back, or the file has two sessions: split it here; do not sort".to_owned(),
    }
}

impl Help for MissingColumn {
    fn help(&self) -> String {
        match &self.reason {
            MissingReason::Content { found, expected } => content(*found, *expected).to_owned(),
            MissingReason::Similar(_) => format!("rename the column to {}, with its numbers in that unit", self.name),
            MissingReason::NoTruth => "add the camera's truth with `proprio align`".to_owned(),
            MissingReason::Unknown => {
                "take the arm or table of this session, or add the column; that of a dead sensor stays, with empty cells; names: docs/reference/files.md"
                    .to_owned()
            }
        }
    }
}

/// Remedy of a file with other content than is expected.
fn content(found: FileContent, expected: FileContent) -> &'static str {
    match (found, expected) {
        (FileContent::Separated(_), _) => "write commas between the columns, and decimal points in the numbers",
        (FileContent::SeparatorLine, _) => {
            "remove the line, and write commas between the columns and decimal points in the numbers"
        }
        (FileContent::Html, _) => "download the file itself, as raw data",
        (_, FileContent::Profile) => "a profile has time_s and pressure1_kpa, pressure2_kpa, …: docs/how-to/driving.md",
        (_, FileContent::Camera) => {
            "a camera's file has time_s, and x, y and heading of each marker: docs/reference/files.md"
        }
        (FileContent::Camera, _) => {
            "join it with the session of the sensors: `proprio align SESSION.csv --camera` this file"
        }
        (FileContent::Profile, _) => "it is for `proprio drive --profile`; take the session that was recorded",
        (FileContent::Estimates, _) => "take the session that was replayed",
        (FileContent::Table, _) => "give it with --table or --arm, and a session before it",
        (FileContent::Session | FileContent::Other, _) => "take a session",
    }
}
