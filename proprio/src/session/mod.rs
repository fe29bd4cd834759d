//! Recorded sessions: CSV, a row a sample, units in the column names, an empty cell for a missing reading; or a board's
//! recording.

mod camera;
mod cell;
mod columns;
mod csv_file;
mod csv_rows;
mod error;
mod header;
mod pressures;
mod reader;
mod source;
mod writer;

use calibration_tables::{ArmFile, FileError, MAX_SEGMENTS};
use estimator_core::Sample;

pub use camera::{CameraReader, Frame};
pub(crate) use columns::{SENSOR_NAMES, TARE};
pub use error::{Problem, SessionError};
pub use header::Header;
pub use pressures::{Moment, read_pressures};
pub use reader::SessionReader;
pub use source::Kind;
pub use writer::{CameraWriter, ImuColumns, SessionWriter};

/// What to say of a file that does not end with a line end.
pub const LAST_LINE: &str = "the last line has no end; its last number may be cut";

/// What a camera sees of a marker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// x, m.
    pub x_m: f64,
    /// y, m.
    pub y_m: f64,
    /// Heading, rad.
    pub heading_rad: f64,
}

/// Where one segment's end truly was, in {W}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// x, m.
    pub x_m: f64,
    /// y, m.
    pub y_m: f64,
    /// Heading of the tangent, rad; `None` in a session that has places alone.
    pub heading_rad: Option<f64>,
}

/// One row: the readings of one tick, and the truth where there is any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The readings.
    pub sample: Sample<MAX_SEGMENTS>,
    /// Where each segment's end was; `None` where the camera did not see it.
    pub truth: [Option<Truth>; MAX_SEGMENTS],
    /// Whether the estimator starts anew before it.
    pub starts: bool,
    /// Where it is from a board's recording: what the board said of it.
    pub board: Option<OnBoard>,
}

/// A moment that a person has marked while it was recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// When, by the clock of the rows, µs.
    pub time_us: u64,
    /// What for.
    pub text: String,
}

/// What a board said of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnBoard {
    /// Number of the tick.
    pub tick: u32,
    /// Whether every sample since the estimator's start is in the recording, so that a replay must give the same.
    pub complete: bool,
    /// The board's estimate, where it was received.
    pub estimate: Option<telemetry::Estimate>,
    /// How far it may be off, where the board has said so.
    pub uncertainty: Option<telemetry::Uncertainty>,
    /// What touches the segments, where the board has said that it has changed.
    pub contact: Option<[bool; telemetry::SEGMENTS]>,
}

impl Row {
    /// True bend angle of segment `i` (from 0), rad: the difference of neighbouring headings, within ±π.
    #[must_use]
    pub fn true_theta(&self, i: usize) -> Option<f64> {
        let before = if i == 0 { 0.0 } else { self.truth.get(i - 1)?.as_ref()?.heading_rad? };
        let turn = self.truth.get(i)?.as_ref()?.heading_rad? - before;
        Some(turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round())
    }
}

/// The columns that a session must have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Needs {
    /// Bend sensors of each segment: 0, 1 (`a`) or 2 (`a` and `b`); `None`: as many as the session has.
    pub bend: Vec<Option<usize>>,
    /// Whether there must be truth.
    pub truth: bool,
}

impl Needs {
    /// What `table` needs of a session.
    ///
    /// # Errors
    /// [`FileError::NotCalibrated`] on an arm description.
    pub fn of_table(table: &ArmFile) -> Result<Self, FileError> {
        let bend = table.bend_sensors()?.into_iter().map(Some).collect();
        Ok(Self { bend, truth: false })
    }

    /// What a calibration of `arm` needs of a session: the bend sensors are those that the session has.
    #[must_use]
    pub fn of_calibration(arm: &ArmFile) -> Self {
        let sensors = |bend: &Vec<_>| bend.is_empty().then_some(0);
        let bend = arm.segments.iter().map(|segment| segment.bend.as_ref().and_then(sensors)).collect();
        Self { bend, truth: true }
    }
}
