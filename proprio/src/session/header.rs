//! What a session is, before anything is known of its arm.

use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;

use telemetry::SEGMENTS;

use super::columns::segment_of;
use super::reader::{BEGIN, Kind};
use super::{Problem, SessionError};

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
    /// [`Problem::Read`], and [`Problem::NotAFile`] of a pipe, whose begin would be gone.
    pub fn of(path: &Path) -> Result<Self, SessionError> {
        let fail = |problem| SessionError { path: path.to_owned(), line: None, column: None, problem };
        let unreadable = |error| fail(Problem::Read(error));
        let mut file = File::open(path).map_err(unreadable)?;
        if !file.metadata().map_err(unreadable)?.is_file() {
            return Err(fail(if path.is_dir() { Problem::Directory } else { Problem::NotAFile }));
        }
        let mut begin = Vec::new();
        file.by_ref().take(BEGIN).read_to_end(&mut begin).map_err(unreadable)?;
        let kind = Kind::of(path, &begin);
        if kind != Kind::Csv {
            return Ok(Self { kind, segments: SEGMENTS, unknown: Vec::new() });
        }
        file.rewind().map_err(unreadable)?;
        let mut csv = csv::Reader::from_reader(file);
        let names = csv.headers().map_err(|_| fail(Problem::NotText))?;
        let names = names.iter().map(str::trim);
        let segments = names.clone().filter_map(segment_of).max().unwrap_or(0);
        let unknown = names.filter(|name| segment_of(name).is_none()).map(str::to_owned).collect();
        Ok(Self { kind, segments, unknown })
    }
}
