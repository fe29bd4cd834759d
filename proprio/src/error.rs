//! Everything that can stop a command, each with what to do about it.

use std::io;
use std::path::PathBuf;

use board_core::FULL_SCALE_PA;
use calibration_tables::FileError;

use crate::align::AlignmentError;
use crate::calibrate::CalibrationError;
use crate::drive::DriveError;
use crate::flash::FlashError;
use crate::link::LinkError;
use crate::session::SessionError;
use crate::tune::TuningError;

/// Why a command stopped.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A session cannot be used.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// An arm description or table cannot be used.
    #[error("{}: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: FileError,
    },
    /// A calibration cannot be made of a session.
    #[error("{}: {source}", path.display())]
    Calibration {
        /// The session.
        path: PathBuf,
        /// What is wrong with it.
        source: CalibrationError,
    },
    /// A board cannot be reached.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A board is not driven, or not any more.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// A board is not flashed.
    #[error(transparent)]
    Flash(#[from] FlashError),
    /// Filters cannot be tuned on a session, or in a table.
    #[error("{}: {source}", path.display())]
    Tuning {
        /// The session or the table.
        path: PathBuf,
        /// What is wrong with it.
        source: TuningError,
    },
    /// A camera's file and a session cannot be brought together.
    #[error("{}: {source}", path.display())]
    Alignment {
        /// The file that is to blame, the camera's where it is both.
        path: PathBuf,
        /// What is wrong.
        source: AlignmentError,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Output {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// An output that would replace its own input.
    #[error("{}: is read by this command and cannot be its output as well", .0.display())]
    Overwrite(PathBuf),
    /// Two outputs of one name.
    #[error("{}: cannot hold two outputs of this command", .0.display())]
    OutputTwice(PathBuf),
    /// An output that would replace a file which cannot be made again.
    #[error("{}: is there already, and a recording cannot be had again", .0.display())]
    Exists(PathBuf),
    /// A name that tells no kind of file.
    #[error("{}: ends with none of .csv, .mcap and .bin, which tell what to write", .0.display())]
    OutputKind(PathBuf),
    /// A conversion to what the input is.
    #[error("{}: is of this kind already", .0.display())]
    SameKind(PathBuf),
    /// Standard output cannot be written.
    #[error("standard output cannot be written: {0}")]
    Stdout(io::Error),
    /// The monitor cannot have its port.
    #[error("port {port} of 127.0.0.1 cannot be listened on: {source}")]
    Listen {
        /// The port.
        port: u16,
        /// Why not.
        source: io::Error,
    },
    /// There is no token.
    #[error("the system gives no random numbers: {0}")]
    Random(io::Error),
    /// The monitor is given a session and no table.
    #[error("a session is shown by what the estimator makes of it, and that takes a table")]
    SessionWithoutTable,
    /// A table whose estimates cannot be smoothed.
    #[error("{}: corrects the drift by the anchor, whose estimates cannot be smoothed", .0.display())]
    NotSmoothed(PathBuf),
    /// `--out` with several sessions.
    #[error("--out takes the estimates of one session, found {0} sessions")]
    OneSession(usize),
    /// A rate that the twin cannot be sampled at.
    #[error("--rate {0} Hz, expected 1 to 1000")]
    Rate(f64),
    /// A duration that cannot be simulated, recorded or driven.
    #[error("--seconds {0}, expected more than 0 and at most 10 million")]
    Seconds(f64),
    /// A pressure that no regulator gives.
    #[error("--kpa {0}, expected 0 to {most}", most = FULL_SCALE_PA / 1000)]
    Pressure(f64),
    /// A change of pressures that is none.
    #[error("--ramp {0} kPa/s, expected more than 0")]
    Ramp(f64),
}

/// A duration that can be simulated, recorded or driven, s.
///
/// # Errors
/// [`Error::Seconds`].
pub fn check_seconds(seconds: f64) -> Result<(), Error> {
    if seconds > 0.0 && seconds <= 1e7 { Ok(()) } else { Err(Error::Seconds(seconds)) }
}

impl Error {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self {
            Self::Session(error) => error.problem.remedy().to_owned(),
            Self::Table { source, .. } => source.remedy().to_owned(),
            Self::Calibration { source, .. } => source.remedy(),
            Self::Link(error) => error.remedy().to_owned(),
            Self::Drive(error) => error.remedy().to_owned(),
            Self::Flash(error) => error.remedy().to_owned(),
            Self::Tuning { source, .. } => source.remedy().to_owned(),
            Self::Alignment { source, .. } => source.remedy().to_owned(),
            Self::Output { .. } => "choose a folder that exists, can be written to and has room".to_owned(),
            Self::Overwrite(_) | Self::OutputTwice(_) | Self::Exists(_) => "give the output another name".to_owned(),
            Self::OutputKind(_) => "give the output one of these endings".to_owned(),
            Self::SameKind(_) => "copy the file, or give the output another ending".to_owned(),
            Self::Stdout(_) => "write to a place that has room, or use --out".to_owned(),
            Self::Listen { .. } => "give another with --listen; is a monitor running already?".to_owned(),
            Self::Random(_) => "watch without --allow-control".to_owned(),
            Self::SessionWithoutTable => "give the arm's table with --table".to_owned(),
            Self::NotSmoothed(_) => {
                "calibrate a table with the bias filter, `[drift] kind = \"kalman\"`, or leave out --smooth".to_owned()
            }
            Self::OneSession(_) => "replay the sessions one by one".to_owned(),
            Self::Rate(_) | Self::Seconds(_) | Self::Pressure(_) | Self::Ramp(_) => {
                "give a value in this range".to_owned()
            }
        }
    }
}
