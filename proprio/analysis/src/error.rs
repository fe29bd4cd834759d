//! Errors of a replay or a report.

use std::path::PathBuf;

/// A session that cannot be replayed, or a result that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A session, a table or an output.
    #[error(transparent)]
    File(#[from] proprio_session::Error),
    /// A table whose estimates cannot be smoothed.
    #[error("{}: corrects the drift by the anchor, whose estimates cannot be smoothed", .0.display())]
    NotSmoothed(PathBuf),
    /// Tables of two arms, which are to be compared.
    #[error("{}: is a table of another arm: its segments have other lengths", .0.display())]
    OtherArm(PathBuf),
}

impl From<proprio_session::SessionError> for Error {
    fn from(error: proprio_session::SessionError) -> Self {
        Self::File(error.into())
    }
}
