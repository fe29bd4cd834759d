//! Shares of the work on covariances, which is quadratic in the number of segments.
//!
//! Up to 50 Hz each sample does all of the work. Above 50 Hz a sample does one share of linear cost: the prediction of
//! one segment's states in the bias filter, the update of the states by that segment, or one block row of the
//! covariance's update.

use core::ops::Range;

use crate::config::AnchorConfig;

/// Highest sample rate at which a sample does all work, mHz.
const WHOLE_UP_TO_MILLIHERTZ: u32 = 50_000;

/// Share of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// All of the work.
    Whole,
    /// Prediction of the segment that is updated next.
    Prediction,
    /// Update of the states by that segment.
    Update,
    /// Update of one block row of the covariance, one segment of the shape's uncertainty, and creep of that segment's
    /// sensors.
    Row(usize),
}

/// Counter of the shares: a prediction, an update, and then a row for each segment of the arm.
#[derive(Debug, Clone, Copy)]
pub struct ShareCounter {
    share: Share,
}

impl ShareCounter {
    /// A prediction is next.
    pub const fn new() -> Self {
        Self { share: Share::Prediction }
    }

    /// Share of this sample.
    pub fn share(&self, config: &AnchorConfig) -> Share {
        if config.sample_rate_millihertz <= WHOLE_UP_TO_MILLIHERTZ { Share::Whole } else { self.share }
    }

    /// Selects the next sample's share, for an arm of `segments`.
    pub fn advance(&mut self, segments: usize) {
        self.share = match self.share {
            Share::Row(row) if row + 1 < segments => Share::Row(row + 1),
            Share::Row(_) | Share::Whole => Share::Prediction,
            Share::Prediction => Share::Update,
            Share::Update => Share::Row(0),
        };
    }
}

impl Share {
    /// Block rows and segments of the share, in an arm of up to `count`.
    pub fn rows(self, count: usize) -> Range<usize> {
        match self {
            Self::Whole => 0..count,
            Self::Row(row) => row..row + 1,
            Self::Prediction | Self::Update => 0..0,
        }
    }
}
