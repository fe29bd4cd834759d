//! One row of a session: readings, truth, and the board's own estimates.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::Sample;

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
