//! Reads what a camera saw: markers' poses, a row a frame, by the camera's own clock.

use std::path::Path;

use calibration_tables::MAX_SEGMENTS;

use crate::columns::CameraColumns;
use crate::csv_file::CsvFile;
use crate::source::Source;
use crate::{Pose, Problem, SessionError, cell};

/// One frame. Poses are in the camera's frame; `None` where a marker was not seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Time by the camera's clock, s.
    pub time_s: f64,
    /// The base's marker.
    pub base: Option<Pose>,
    /// The marker at each segment's end.
    pub ends: [Option<Pose>; MAX_SEGMENTS],
}

/// A camera's file that is being read.
pub struct CameraReader {
    file: CsvFile,
    columns: CameraColumns,
    last_time_s: f64,
}

impl CameraReader {
    /// Opens the file for an arm of `segments` segments.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header.
    pub fn open(path: &Path, segments: usize) -> Result<Self, SessionError> {
        let file = CsvFile::new(Source::open(path)?)?;
        let columns = CameraColumns::find(file.names(), segments).map_err(|problem| file.header_error(problem))?;
        Ok(Self { file, columns, last_time_s: f64::NEG_INFINITY })
    }

    /// Whether there are columns of the base's marker.
    #[must_use]
    pub fn has_base(&self) -> bool {
        self.columns.base.is_some()
    }

    /// Whether the last line is ended; if not, its last number may have been cut.
    #[must_use]
    pub fn ends_with_line(&self) -> bool {
        self.file.ends_with_line()
    }

    /// How far the file was read, and its size, in bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        self.file.progress()
    }

    /// The next frame, or `None` at the end.
    ///
    /// # Errors
    /// Any [`SessionError`] of a row.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, SessionError> {
        if !self.file.advance()? {
            return Ok(None);
        }
        let time_s = self.file.cell(self.columns.time, cell::clock_s)?;
        if time_s < self.last_time_s {
            let problem = Problem::Backwards { from_s: self.last_time_s, to_s: time_s };
            return Err(self.file.cell_error(self.columns.time, problem));
        }
        self.last_time_s = time_s;
        let base = self.columns.base.map_or(Ok(None), |columns| self.file.pose(columns))?;
        let mut ends = [None; MAX_SEGMENTS];
        for (end, columns) in ends.iter_mut().zip(&self.columns.ends) {
            *end = self.file.pose(*columns)?;
        }
        Ok(Some(Frame { time_s, base, ends }))
    }
}
