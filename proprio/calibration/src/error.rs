//! Errors of calibration, tuning and alignment.

use std::path::PathBuf;

use crate::align::AlignmentError;
use crate::calibrate::CalibrationError;
use crate::truth_error::TruthError;
use crate::tune::TuningError;

/// A table that cannot be made, or truth that cannot be aligned.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A session, a table or an output.
    #[error(transparent)]
    File(#[from] proprio_session::Error),
    /// A replay of a session.
    #[error(transparent)]
    Replay(#[from] proprio_analysis::Error),
    /// The truth of a session or a camera's file cannot be used.
    #[error("{}: {source}", path.display())]
    Truth {
        /// The file.
        path: PathBuf,
        /// The problem.
        source: Box<TruthError>,
    },
    /// A calibration cannot be made of a session.
    #[error("{}: {source}", path.display())]
    Calibration {
        /// The session.
        path: PathBuf,
        /// The problem.
        source: CalibrationError,
    },
    /// Filters cannot be tuned on a session, or in a table.
    #[error("{}: {source}", path.display())]
    Tuning {
        /// The session or the table.
        path: PathBuf,
        /// The problem.
        source: TuningError,
    },
    /// A camera's file and a session do not fit together.
    #[error("{}: {source}", path.display())]
    Alignment {
        /// The file at fault; the camera's where it is both.
        path: PathBuf,
        /// The problem.
        source: AlignmentError,
    },
}

impl From<proprio_session::SessionError> for Error {
    fn from(error: proprio_session::SessionError) -> Self {
        Self::File(error.into())
    }
}
