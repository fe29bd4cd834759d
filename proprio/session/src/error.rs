//! Errors of files: sessions, tables, outputs.

use std::io;
use std::path::PathBuf;

use calibration_tables::FileError;

use crate::session_error::SessionError;

/// A file that cannot be read or written.
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
        /// The problem.
        source: FileError,
    },
    /// A file cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Output {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// An output that would replace its own input.
    #[error("{}: is read by this command and cannot be its output as well", .0.display())]
    Overwrite(PathBuf),
    /// An output that would replace a file unasked.
    #[error("{}: is there already and is not replaced", .0.display())]
    Exists(PathBuf),
    /// A recording that would replace a file.
    #[error("{}: is there already, and a recording replaces no file", .0.display())]
    RecordingExists(PathBuf),
    /// A name without the ending of a kind of file.
    #[error("{}: ends with none of .csv, .mcap and .bin, which select the format", .0.display())]
    OutputKind(PathBuf),
    /// A conversion to the kind of the input.
    #[error("{}: is of this kind already", .0.display())]
    SameKind(PathBuf),
}
