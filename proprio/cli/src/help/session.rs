//! Remedies of errors of sessions.

use proprio_session::SessionProblem;
use proprio_session::recording::ReadError;

use super::Help;

/// Time after which a clock of 32 bits wraps that counts microseconds, s.
const MICROS_WRAP_S: f64 = 4_294.967_296;

impl Help for SessionProblem {
    fn help(&self) -> String {
        let help = match self {
            Self::Read(_) | Self::Recording(ReadError::Read(_)) => "check the name and that you may read it",
            Self::Directory => "name the .csv file in it",
            Self::NoHeader | Self::NoSamples | Self::NothingWhole => "record the session again, or take another",
            Self::LongLine => "end each row with a line end; is it a CSV? copy the file again, or take another",
            Self::NotText => "save it as CSV in UTF-8",
            Self::MissingColumn(_) => {
                "take the arm or table of this session, or add the column; names are as in docs/reference/files.md, between commas"
            }
            Self::DuplicateColumn(_) => "remove or rename one of them",
            Self::OtherArm { .. } | Self::RecordedSegments(_) => {
                "take the arm description or table of the arm that was recorded"
            }
            Self::RowLength { .. } => {
                "the file was cut or edited, or has decimal commas: remove the row, copy the file again, or use points"
            }
            Self::NotCsv => "make a CSV of it with `proprio convert`",
            Self::HasTruth(_) => "take the session as it was recorded, or use it as it is: it is aligned",
            Self::NoTime | Self::Time(_) | Self::Clock(_) => "give every row its time in seconds",
            Self::NoPressure => "give every regulator its pressure in every row; 0 is vented",
            Self::Pressure(_) => "write pressures over the atmosphere's: in kPa in _kpa, in Pa in _pa",
            Self::NoMoments => "give at least one row",
            Self::NotANumber(_) => "write numbers with a decimal point, and leave the cell of a missing reading empty",
            Self::NotFinite(_) => "leave the cell empty",
            Self::Counts(_) => "write raw ADC counts, and leave the cell of a missing reading empty",
            Self::Truth(_) => "correct the value, or leave all cells of this truth empty",
            Self::NotAFile => "save it as a file first",
            Self::Tare(_) => "write the number, or remove the column",
            Self::Recording(ReadError::Cut) => "recover its complete part with `proprio recover`",
            Self::Recording(ReadError::OtherForm(_) | ReadError::OtherProtocol(_)) => {
                "read it with the proprio of that version"
            }
            Self::Recording(ReadError::NoMcap) => "name a recording (.mcap); other sessions are used as they are",
            Self::Recording(ReadError::Foreign(_)) => {
                "take a recording of `proprio record`, or make a CSV of this one's samples (docs/reference/files.md)"
            }
            Self::Recording(ReadError::Damaged(_)) => {
                "recover its complete part with `proprio recover`, or take another"
            }
            Self::TooManySegments(_) => "keep it as CSV",
            Self::NoTruth => "give a session with the camera's truth (docs/reference/files.md)",
            Self::Heading(_) => "write headings from 0 up to a full turn: 360 in _deg, 2π in _rad",
            Self::Backwards { from_s, to_s } if (from_s - to_s - MICROS_WRAP_S).abs() < 1.0 => {
                "the clock's 32 bits of microseconds have wrapped: add 4294.967296 s from here on; do not sort"
            }
            Self::Backwards { .. } => "sort the rows by time; two sessions in one file must be split",
            Self::PartialQuaternion | Self::NotUnit(_) => {
                "write unit quaternions w, x, y, z, and leave all four cells of a missing reading empty"
            }
            Self::PartialTruth => "leave all its cells empty where the camera did not see the segment",
        };
        help.to_owned()
    }
}
