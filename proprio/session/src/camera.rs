//! Reads a camera's file: poses of markers, one row per frame, by the camera's own clock.

use std::path::Path;

use calibration_tables::MAX_SEGMENTS;

use crate::columns::CameraColumns;
use crate::csv_file::CsvFile;
use crate::source::SessionFile;
use crate::{FileDefects, Pose, SessionError, SessionProblem, cell};

/// One image of the camera. Poses are in the camera's frame; `None` where a marker was not seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraFrame {
    /// Time by the camera's clock, s.
    pub time_s: f64,
    /// The base's marker.
    pub base: Option<Pose>,
    /// The marker at each segment's end.
    pub ends: [Option<Pose>; MAX_SEGMENTS],
}

/// Reader of a camera's file.
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
        let file = CsvFile::new(SessionFile::open(path)?)?;
        let columns = CameraColumns::find(file.names(), segments).map_err(|problem| file.header_error(problem))?;
        Ok(Self { file, columns, last_time_s: f64::NEG_INFINITY })
    }

    /// True where there are columns of the base's marker.
    #[must_use]
    pub fn has_base(&self) -> bool {
        self.columns.base.is_some()
    }

    /// The file's defects.
    #[must_use]
    pub fn defects(&self) -> FileDefects {
        FileDefects { last_line_is_open: !self.file.ends_with_line(), holes: Vec::new() }
    }

    /// Position in the file and its size, bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        self.file.progress()
    }

    /// The next frame, or `None` at the end.
    ///
    /// # Errors
    /// Any [`SessionError`] of a row.
    pub fn next_frame(&mut self) -> Result<Option<CameraFrame>, SessionError> {
        if !self.file.advance()? {
            return Ok(None);
        }
        let time_s = self.file.cell(self.columns.time, cell::clock_s)?;
        if time_s < self.last_time_s {
            let problem = SessionProblem::Backwards { from_s: self.last_time_s, to_s: time_s };
            return Err(self.file.cell_error(self.columns.time, problem));
        }
        self.last_time_s = time_s;
        let base = self.columns.base.map_or(Ok(None), |columns| self.file.pose(columns))?;
        let mut ends = [None; MAX_SEGMENTS];
        for (end, columns) in ends.iter_mut().zip(&self.columns.ends) {
            *end = self.file.pose(*columns)?;
        }
        Ok(Some(CameraFrame { time_s, base, ends }))
    }
}
