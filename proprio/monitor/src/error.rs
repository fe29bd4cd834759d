//! Errors of the live page's server.

use std::io;
use std::path::PathBuf;

/// A page that cannot be served, or a file that it requests.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A session, a table or a recording.
    #[error(transparent)]
    File(#[from] proprio_session::Error),
    /// A session without a table, and no other is known.
    #[error("is shown with the estimates of a replay, which needs a table, and none is in it, on the board, or given")]
    NoTable,
    /// A table that is not in the folder.
    #[error("{0}: there is no such table in the folder of this monitor")]
    NoSuchTable(String),
    /// The recorder's thread has panicked.
    #[error("{}: is incomplete: the recorder has stopped by a fault of proprio", .0.display())]
    RecorderPanicked(PathBuf),
    /// A request to the board.
    #[error(transparent)]
    Link(#[from] proprio_link::LinkError),
    /// The monitor's table cannot be stored on a board.
    #[error(transparent)]
    TableImage(#[from] proprio_link::table::TableImageError),
    /// The transfer of the table to the board.
    #[error(transparent)]
    Transfer(#[from] proprio_link::table::TransferError),
    /// The port cannot be opened.
    #[error("port {port} of 127.0.0.1 cannot be listened on: {source}")]
    Listen {
        /// The port.
        port: u16,
        /// The system's reason.
        source: io::Error,
    },
    /// The system has no random numbers for a token.
    #[error("the system gives no random numbers: {0}")]
    Random(io::Error),
}

impl From<proprio_session::SessionError> for Error {
    fn from(error: proprio_session::SessionError) -> Self {
        Self::File(error.into())
    }
}
