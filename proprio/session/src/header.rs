//! What a session is, before anything is known of its arm.

use std::path::Path;

use telemetry::SEGMENTS;

use crate::columns::segment_of;
use crate::csv_file::CsvFile;
use crate::source::{Kind, Source};
use crate::{Problem, SessionError};

/// What can be told of a session by its begin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// What the file is.
    pub kind: Kind,
    /// Segments of a CSV, by its columns; those of a board otherwise.
    pub segments: usize,
    /// Columns of a CSV that a session does not have.
    pub unknown: Vec<String>,
}

impl Header {
    /// Reads the begin of a file.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header, and [`Problem::NotAFile`] of a pipe, whose begin would be gone.
    pub fn of(path: &Path) -> Result<Self, SessionError> {
        let source = Source::open(path)?;
        if !source.is_regular_file {
            return Err(source.error(Problem::NotAFile));
        }
        let kind = source.kind;
        if kind != Kind::Csv {
            return Ok(Self { kind, segments: SEGMENTS, unknown: Vec::new() });
        }
        let file = CsvFile::new(source)?;
        let names = file.names().iter();
        let segments = names.clone().filter_map(|name| segment_of(name)).max().unwrap_or(0);
        let unknown = names.filter(|name| segment_of(name).is_none()).cloned().collect();
        Ok(Self { kind, segments, unknown })
    }
}
