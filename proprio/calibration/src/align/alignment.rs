//! An alignment of a camera's clock and a session's, and its quality.

use proprio_session::FileDefects;

use proprio_check::clock_fit::{Clocks, ComparedSensors};

use super::frames::Frames;
use super::motion::Readings;
use crate::truth::JudgedTruth;

/// A camera's recording and a session on one clock.
pub struct Alignment {
    pub(super) frames: Frames,
    pub(super) readings: Readings,
    pub(super) clocks: Clocks,
    /// Defects of the session's and of the camera's file.
    pub defects: [FileDefects; 2],
    /// Quality of the alignment.
    pub report: AlignmentReport,
}

impl Alignment {
    /// The findings about the camera's poses.
    #[must_use]
    pub const fn truth(&self) -> &JudgedTruth {
        &self.frames.truth
    }

    /// Names of the bodies of a motion-capture program's export, from the base to the tip; `None` of other cameras' files.
    #[must_use]
    pub fn bodies(&self) -> Option<&[String]> {
        self.frames.bodies.as_deref()
    }
}

/// Offset, rate and quality of an alignment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlignmentReport {
    /// Sensors that were compared with the camera.
    pub sensors: ComparedSensors,
    /// The camera's time less the session's, in the middle of their overlap, s.
    pub offset_s: f64,
    /// Standard error of the offset, from the scatter of pieces of the recording, ms. A lag common to all of them is not in it.
    pub offset_error_ms: f64,
    /// Middle of the overlap by the session's clock, s.
    pub middle_s: f64,
    /// Rate by which the camera's clock is faster, ppm.
    pub skew_ppm: f64,
    /// Standard error of the rate, ppm.
    pub skew_error_ppm: f64,
    /// Root mean square of the residual lags of pieces of 20 s after offset and skew, ms.
    pub residual_ms: f64,
    /// Median of the sensors' correlations with the camera.
    pub correlation: f64,
    /// Number of moments, ten per second, at which both were compared.
    pub matched: usize,
}
