//! Invariants of the soak, and what breaks them.

use std::fmt;

/// What holds at all times, faults or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invariant {
    /// The board restarts by a fault that restarts it alone.
    Restart,
    /// Every tick has its sample, unless a fault takes it away.
    EveryTick,
    /// Counters of `Health` never decrease within a boot.
    Counters,
    /// No tick is missed, unless a fault holds it up.
    Overruns,
    /// After the tare every segment is known.
    Known,
    /// Estimates, uncertainties and contacts are the host's of the same samples, bit for bit.
    Replay,
    /// The tip is within three stated standard deviations of the truth, or the estimate is flagged.
    Tip,
    /// Without a host, and after a restart, the arm is vented after 1.5 s and stays so.
    Vented,
}

impl fmt::Display for Invariant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Restart => "restart",
            Self::EveryTick => "every-tick",
            Self::Counters => "counters",
            Self::Overruns => "overruns",
            Self::Known => "known",
            Self::Replay => "replay",
            Self::Tip => "tip",
            Self::Vented => "vented",
        })
    }
}

/// An invariant that did not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Which.
    pub invariant: Invariant,
    /// Time since power-on, s.
    pub time_s: f64,
    /// What was found, with its figures.
    pub figure: String,
    /// Size for comparison with others of the invariant.
    pub size: f64,
}

impl Finding {
    /// A finding without a size.
    pub(super) const fn new(invariant: Invariant, time_s: f64, figure: String) -> Self {
        Self { invariant, time_s, figure, size: 0.0 }
    }
}
