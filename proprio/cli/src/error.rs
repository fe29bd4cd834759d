//! Errors that stop a command; `help/` has their remedies.

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

use board_table::MAX_FULL_SCALE_PA;
use proprio_link::drive::DriveError;
use proprio_link::table::{TableImageError, TransferError};
use proprio_link::{LinkError, TareError};
use proprio_session::DurationError;
use proprio_simulation::SimulationError;
use rig_twin::LayoutError;

use crate::arm::NewArmError;
use crate::flash::FlashError;

/// An error that stops a command.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A session, a table or an output.
    #[error(transparent)]
    File(#[from] proprio_session::Error),
    /// A replay or a report.
    #[error(transparent)]
    Analysis(#[from] proprio_analysis::Error),
    /// Calibration, tuning or alignment.
    #[error(transparent)]
    Calibration(#[from] proprio_calibration::Error),
    /// The live page.
    #[error(transparent)]
    Monitor(#[from] proprio_monitor::Error),
    /// A running monitor, through which the board is reached.
    #[error(transparent)]
    RunningMonitor(#[from] proprio_monitor::RunningMonitorError),
    /// The running monitor that has the board's line does not stream.
    #[error("the monitor at http://{0} has the board's line, and does not stream")]
    NoStream(SocketAddr),
    /// The live stream for other viewers.
    #[error(transparent)]
    Foxglove(#[from] proprio_foxglove::Error),
    /// A board cannot be reached.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A board cannot be driven, or not any more.
    #[error(transparent)]
    Drive(#[from] DriveError),
    /// A board was not tared.
    #[error(transparent)]
    Tare(#[from] TareError),
    /// A table cannot be stored on a board.
    #[error("{name}: {source}")]
    TableImage {
        /// Name of the table's file.
        name: String,
        /// The reason.
        source: TableImageError,
    },
    /// A table was not transferred.
    #[error(transparent)]
    Transfer(#[from] TransferError),
    /// A board cannot be flashed.
    #[error(transparent)]
    Flash(#[from] FlashError),
    /// A new arm cannot be described.
    #[error(transparent)]
    NewArm(#[from] NewArmError),
    /// A session cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// An arm that the simulation has no room for.
    #[error("{}: {source}", path.display())]
    Layout {
        /// The arm's file.
        path: PathBuf,
        /// The reason.
        source: LayoutError,
    },
    /// Two outputs of one name.
    #[error("{}: cannot hold two outputs of this command", .0.display())]
    OutputTwice(PathBuf),
    /// Standard output cannot be written.
    #[error("standard output cannot be written: {0}")]
    Stdout(io::Error),
    /// The monitor is given a session and no table.
    #[error("a session is shown with the estimates of a replay, which needs a table")]
    SessionWithoutTable,
    /// A session is checked without a table.
    #[error("{}: a session is checked by the table of its arm", .0.display())]
    CheckWithoutTable(PathBuf),
    /// `--out` with several sessions.
    #[error("--out takes the estimates of one session, found {0} sessions")]
    OneSession(usize),
    /// Estimates that a recording has no channel for.
    #[error("{}: a recording has no channel for the estimates of {option}", path.display())]
    NoChannel {
        /// The output.
        path: PathBuf,
        /// The option that makes them.
        option: &'static str,
    },
    /// `convert --table` of other formats.
    #[error("--table adds estimates to a recording (.mcap) that is made of a CSV, found {} to {}", input.display(), output.display())]
    EstimatesOfConversion {
        /// The session.
        input: PathBuf,
        /// The file to write.
        output: PathBuf,
    },
    /// A duration that cannot be recorded or driven.
    #[error(transparent)]
    Seconds(#[from] DurationError),
    /// A pressure over the full scale of any regulator.
    #[error("--kpa {0}, expected 0 to {most}", most = MAX_FULL_SCALE_PA / 1000)]
    Pressure(f64),
    /// A rate of change of pressures that is not positive.
    #[error("--ramp {0} kPa/s, expected more than 0")]
    Ramp(f64),
}

impl Error {
    /// True for a fault of proprio itself.
    pub fn is_fault(&self) -> bool {
        matches!(self, Self::Monitor(proprio_monitor::Error::RecorderPanicked(_)))
    }
}

impl From<proprio_session::SessionError> for Error {
    fn from(error: proprio_session::SessionError) -> Self {
        Self::File(error.into())
    }
}
