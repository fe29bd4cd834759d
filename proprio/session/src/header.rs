//! Format and size of a session, before its arm is known.

use std::path::Path;

use crate::column_names::segment_of;
use crate::csv_file::CsvFile;
use crate::reader::board_segments;
use crate::shown::shown;
use crate::source::{FileFormat, SessionFile};
use crate::{SessionError, SessionProblem};

/// The begin of a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// Format of the file.
    pub kind: FileFormat,
    /// Segments of a CSV, by its columns; those of the first sample otherwise.
    pub segments: usize,
    /// Columns of a CSV that a session does not have, as they can be shown.
    pub unknown: Vec<String>,
}

impl Header {
    /// Reads the begin of a file.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header and the first sample, and [`SessionProblem::NotAFile`] of a pipe, whose begin would be gone.
    pub fn of(path: &Path) -> Result<Self, SessionError> {
        let source = SessionFile::open(path)?;
        if !source.is_regular_file {
            return Err(source.error(SessionProblem::NotAFile));
        }
        let kind = source.kind;
        if kind != FileFormat::Csv {
            return Ok(Self { kind, segments: board_segments(source)?, unknown: Vec::new() });
        }
        let file = CsvFile::new(source)?;
        let names = file.names().iter();
        let segments = names.clone().filter_map(|name| segment_of(name)).max().unwrap_or(0);
        let unknown = names.filter(|name| segment_of(name).is_none()).map(|name| shown(name)).collect();
        Ok(Self { kind, segments, unknown })
    }
}
