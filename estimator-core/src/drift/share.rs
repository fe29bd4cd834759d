//! Shares of the work on covariances, which is quadratic in the number of segments.
//!
//! Up to 50 Hz a sample does all of it. Above, a sample does one share, which is linear: an update of the bias filter by one
//! segment, or one block row of what follows from it. So every sample costs the same.

use crate::config::AnchorConfig;

/// Highest sample rate at which a sample does all work, mHz.
const WHOLE_UP_TO_MILLIHERTZ: u32 = 50_000;

/// Share of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// All of it.
    Whole,
    /// An update by one segment.
    Update,
    /// One block row of the covariance, and one segment of the shape's.
    Row(usize),
}

/// Counter of the shares: an update, and then all `N` rows.
#[derive(Debug, Clone, Copy)]
pub struct ShareCounter<const N: usize> {
    row: Option<usize>,
}

impl<const N: usize> ShareCounter<N> {
    /// An update is next.
    pub const fn new() -> Self {
        Self { row: None }
    }

    /// Share of this sample.
    pub fn share(&self, rule: &AnchorConfig) -> Share {
        if rule.sample_rate_millihertz <= WHOLE_UP_TO_MILLIHERTZ {
            return Share::Whole;
        }
        self.row.map_or(Share::Update, Share::Row)
    }

    /// Goes on to the next share.
    pub fn advance(&mut self) {
        let next = self.row.map_or(0, |row| row + 1);
        self.row = (next < N).then_some(next);
    }
}
