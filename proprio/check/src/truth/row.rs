//! The truth of a row or a camera's frame, with the IMUs' headings of the same time.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Phase};
use proprio_session::{Row, Truth};

use crate::finding::Rows;

/// The truth of one row.
#[derive(Debug, Clone, Copy)]
pub struct TruthRow {
    /// Number of the row, from 1.
    pub row: u64,
    /// Its time, s.
    pub time_s: f64,
    /// The estimator starts before this row, and the IMUs' headings have a new zero.
    pub starts: bool,
    /// Pose of each segment's end.
    pub poses: [Option<Truth>; MAX_SEGMENTS],
    /// Heading of each IMU within a turn, rad; `None` where it was not read, and in a camera's file.
    pub imu: [Option<f64>; MAX_SEGMENTS],
}

impl TruthRow {
    /// The truth of row `number` of a session, from 1.
    #[must_use]
    pub fn of(row: &Row, number: u64) -> Self {
        let headings = row.sample.imu.each_ref().map(|imu| imu.as_ref().and_then(ImuReading::heading));
        Self::new(row, number, &headings)
    }

    /// The same, with the headings of its IMUs.
    pub(crate) fn new(row: &Row, number: u64, headings: &[Option<Phase>; MAX_SEGMENTS]) -> Self {
        Self {
            row: number,
            time_s: row.sample.time_us as f64 / 1e6,
            starts: row.starts,
            poses: row.truth,
            imu: headings.map(|heading| heading.map(Phase::rad)),
        }
    }

    /// The row as a finding has it.
    pub(super) fn rows(&self) -> Rows {
        Rows { count: 1, first: self.row, last: self.row, from_s: self.time_s, to_s: self.time_s }
    }
}
