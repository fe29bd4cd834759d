//! Reads a camera's file: poses of markers, one row per frame, by the camera's own clock; or the export of a motion-capture program.

use std::path::Path;

use calibration_tables::MAX_SEGMENTS;

use crate::columns::CameraColumns;
use crate::csv_file::CsvFile;
use crate::motion_capture::{BodyFrame, BodySelection, MotionCaptureProblem, MotionCaptureReader};
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
pub struct CameraReader(Source);

enum Source {
    Markers(Box<MarkerFile>),
    Bodies { reader: Box<MotionCaptureReader>, has_base: bool },
}

/// A CSV file with a column for each coordinate of a marker.
struct MarkerFile {
    file: CsvFile,
    columns: CameraColumns,
    last_time_s: f64,
}

impl CameraReader {
    /// Opens the file for an arm of `segments` segments; `bodies` selects those of a motion-capture program's export.
    ///
    /// # Errors
    /// Any [`SessionError`] of the header.
    pub fn open(path: &Path, segments: usize, bodies: &BodySelection) -> Result<Self, SessionError> {
        let source = SessionFile::open(path)?;
        if MotionCaptureReader::is_export(&source) {
            let reader = Box::new(MotionCaptureReader::new(source, segments, bodies)?);
            let has_base = reader.bodies().len() > segments;
            return Ok(Self(Source::Bodies { reader, has_base }));
        }
        let file = CsvFile::new(source)?;
        if *bodies != BodySelection::default() {
            return Err(file.error(SessionProblem::MotionCapture(Box::new(MotionCaptureProblem::NotAnExport))));
        }
        let columns = CameraColumns::find(file.names(), segments).map_err(|problem| file.header_error(problem))?;
        let markers = MarkerFile { file, columns, last_time_s: f64::NEG_INFINITY };
        Ok(Self(Source::Markers(Box::new(markers))))
    }

    /// True where there are poses of the base.
    #[must_use]
    pub const fn has_base(&self) -> bool {
        match &self.0 {
            Source::Markers(markers) => markers.columns.base.is_some(),
            Source::Bodies { has_base, .. } => *has_base,
        }
    }

    /// Names of the bodies from the base to the tip, whose axes may be turned in any way; `None` of a file of markers, whose axes
    /// are the arm's.
    #[must_use]
    pub fn bodies(&self) -> Option<Vec<String>> {
        match &self.0 {
            Source::Markers(_) => None,
            Source::Bodies { reader, .. } => Some(reader.bodies().map(str::to_owned).collect()),
        }
    }

    /// The file's defects.
    #[must_use]
    pub fn defects(&self) -> FileDefects {
        match &self.0 {
            Source::Markers(markers) => {
                FileDefects { last_line_is_open: !markers.file.ends_with_line(), holes: Vec::new() }
            }
            Source::Bodies { reader, .. } => reader.defects(),
        }
    }

    /// Position in the file and its size, bytes.
    #[must_use]
    pub fn progress(&self) -> (u64, u64) {
        match &self.0 {
            Source::Markers(markers) => markers.file.progress(),
            Source::Bodies { reader, .. } => reader.progress(),
        }
    }

    /// The next frame, or `None` at the end.
    ///
    /// # Errors
    /// Any [`SessionError`] of a row.
    pub fn next_frame(&mut self) -> Result<Option<CameraFrame>, SessionError> {
        match &mut self.0 {
            Source::Markers(markers) => markers.next_frame(),
            Source::Bodies { reader, has_base } => {
                let Some(BodyFrame { time_s, poses }) = reader.next_frame()? else { return Ok(None) };
                let mut poses = poses.into_iter();
                let base = if *has_base { poses.next().flatten() } else { None };
                let mut ends = [None; MAX_SEGMENTS];
                ends.iter_mut().zip(poses).for_each(|(end, pose)| *end = pose);
                Ok(Some(CameraFrame { time_s, base, ends }))
            }
        }
    }
}

impl MarkerFile {
    fn next_frame(&mut self) -> Result<Option<CameraFrame>, SessionError> {
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
