//! Holes of a damaged recording.

use std::fmt;

/// A damaged part of a recording, which is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hole {
    /// Its place in the file, bytes.
    pub offset: u64,
    /// Its length, bytes.
    pub bytes: u64,
    /// Time of the last message before it, ns since 1970; `None` at the begin.
    pub from_ns: Option<u64>,
    /// Time of the first message behind it, ns since 1970; `None` at the end.
    pub to_ns: Option<u64>,
}

/// Times of a hole, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoleTimes {
    /// Time of the last sample before it; `None` at the begin.
    pub from_s: Option<f64>,
    /// Time of the first sample behind it; `None` at the end.
    pub to_s: Option<f64>,
}

impl Hole {
    /// This hole and the next one, without a message between them.
    pub(super) fn with(self, next: &Self) -> Self {
        Self { bytes: next.offset + next.bytes - self.offset, ..self }
    }

    /// Times of this hole since `start_ns`.
    #[must_use]
    pub fn times(&self, start_ns: u64) -> HoleTimes {
        let seconds = |ns: u64| ns.saturating_sub(start_ns) as f64 / 1e9;
        HoleTimes { from_s: self.from_ns.map(seconds), to_s: self.to_ns.map(seconds) }
    }
}

impl fmt::Display for HoleTimes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.from_s, self.to_s) {
            (Some(from), Some(to)) => write!(f, "{from:.2} s to {to:.2} s")?,
            (Some(from), None) => write!(f, "{from:.2} s to the end")?,
            (None, Some(to)) => write!(f, "the begin to {to:.2} s")?,
            (None, None) => write!(f, "all of it")?,
        }
        write!(f, " is damaged and left out")
    }
}
