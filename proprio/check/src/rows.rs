//! Rows of a finding.

use std::fmt;

use serde::Serialize;

use super::frame::Frame;

/// Rows of a finding. Rows count from 1, without the header.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Rows {
    /// Number of the rows.
    pub count: u64,
    /// The first of them.
    pub first: u64,
    /// The last of them.
    pub last: u64,
    /// Time of the first, s.
    pub from_s: f64,
    /// Time of the last, s.
    pub to_s: f64,
}

impl Rows {
    /// Adds a row.
    pub(super) fn add(&mut self, frame: &Frame) {
        self.append(&Self { count: 1, first: frame.row, last: frame.row, from_s: frame.time_s, to_s: frame.time_s });
    }

    /// Appends later rows.
    pub(super) fn append(&mut self, later: &Self) {
        if self.count == 0 {
            *self = *later;
        } else {
            *self = Self { count: self.count + later.count, last: later.last, to_s: later.to_s, ..*self };
        }
    }
}

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, first, last, from_s, to_s } = self;
        if first == last {
            write!(f, "row {first} ({from_s:.3} s)")
        } else if *count > last - first {
            write!(f, "rows {first} to {last} ({from_s:.3} to {to_s:.3} s)")
        } else {
            write!(f, "{count} of rows {first} to {last} ({from_s:.3} to {to_s:.3} s)")
        }
    }
}
