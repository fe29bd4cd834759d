//! One row of a session: readings, truth, and the board's own estimates.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::Sample;

use crate::clock::HostNs;

/// Pose of a marker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// x, m.
    pub x_m: f64,
    /// y, m.
    pub y_m: f64,
    /// Heading, rad.
    pub heading_rad: f64,
}

/// True pose of one segment's end in {W}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// x, m.
    pub x_m: f64,
    /// y, m.
    pub y_m: f64,
    /// Heading of the tangent, rad; `None` in a session with positions alone.
    pub heading_rad: Option<f64>,
}

/// One row: the readings of one tick, and the truth where it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The readings.
    pub sample: Sample<MAX_SEGMENTS>,
    /// True pose of each segment's end; `None` where the camera did not see it.
    pub truth: [Option<Truth>; MAX_SEGMENTS],
    /// The estimator is started (again) before this row.
    pub starts: bool,
    /// The board's output for this row; `None` in a CSV.
    pub board: Option<BoardOutput>,
}

/// A mark that a person has set during a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mark {
    /// Its time on the clock of the rows, µs.
    pub time_us: u64,
    /// Its text.
    pub text: String,
}

/// Output of a board for one sample.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardOutput {
    /// Number of the tick.
    pub tick: u32,
    /// The board's time of the tick since its boot, µs.
    pub time_us: u64,
    /// Segments of the board's arm.
    pub segments: usize,
    /// Time of the sample's arrival; 0 in a raw file.
    pub at: HostNs,
    /// Every sample since the estimator's start was received, so that a replica of the estimator gives the same result.
    pub complete: bool,
    /// False for a sample from before the begin of the recording, which is there for the state of the estimator alone.
    pub recorded: bool,
    /// The board's estimate, where it was received.
    pub estimate: Option<telemetry::Estimate>,
    /// Uncertainty of the estimate, where the board has sent one.
    pub uncertainty: Option<telemetry::Uncertainty>,
    /// Contact of the segments, where the board has sent a change of it: bit i is segment i, from 0.
    pub contact: Option<u8>,
    /// Set-points of the regulators, Pa, where the board has sent them.
    pub set_pa: Option<Vec<u32>>,
    /// Pressures that the host has requested, Pa, where it has after the row before.
    pub requested_pa: Option<Vec<u32>>,
}

impl Row {
    /// True where the row is part of the session: all but those from before the begin of a recording.
    #[must_use]
    pub fn is_recorded(&self) -> bool {
        self.board.as_ref().is_none_or(|board| board.recorded)
    }

    /// True where an estimator over the rows has the state of the board's, or there is no board.
    #[must_use]
    pub fn is_comparable(&self) -> bool {
        self.board.as_ref().is_none_or(|board| board.complete)
    }

    /// True bend angle of segment `i` (from 0), rad: the difference of neighbouring headings, within ±π.
    #[must_use]
    pub fn true_theta(&self, i: usize) -> Option<f64> {
        let before = if i == 0 { 0.0 } else { self.truth.get(i - 1)?.as_ref()?.heading_rad? };
        let turn = self.truth.get(i)?.as_ref()?.heading_rad? - before;
        Some(turn - std::f64::consts::TAU * (turn / std::f64::consts::TAU).round())
    }
}
