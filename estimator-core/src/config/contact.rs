//! Configuration of contact detection.

use crate::numeric::phase::Turns;

/// Thresholds of contact detection for segments without [limits](ContactLimits) of their own: changes within five values that
/// a free arm does not make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContactConfig {
    /// Of a segment's IMUs against its bend sensors, a quarter of the motion taken off.
    pub bend: Turns,
    /// Of a segment against the one that it is coupled to.
    pub coupling: Turns,
}

/// An earlier segment that bends alike in free motion: θ = ratio · θ of that one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CoupledSegment {
    /// Its place in the table, from 0.
    pub segment: u8,
    /// In units of 2⁻²⁸, within ±8.
    pub ratio: i32,
}

/// Contact detection of one segment by limits from the scatter of the calibration sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContactLimits {
    /// Change of the IMUs against the bend sensors; `None`: contact is not detected by it.
    pub bend: Option<ChangeLimit>,
    /// Response to, and change against the coupled segment; `None`: contact is not detected by it.
    pub coupling: Option<Coupling>,
}

/// Limit of the change of a residual within a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChangeLimit {
    /// Change that the free arm does not reach.
    pub change: Turns,
    /// Motion within half a second that the sweep has shown. What exceeds it is taken off the change, in part.
    pub motion: Turns,
}

/// Coupling of a segment to an earlier one in free motion: the responses of both to the same pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Coupling {
    /// θ over that of the coupled segment where the latter is negative, in units of 2⁻²⁸, within ±8.
    pub ratio_left: i32,
    /// What the coupled segment's angle passes before the comparison.
    pub lead: Response,
    /// What the segment's own angle passes.
    pub own: Response,
    /// Limit of the change of the residual.
    pub limit: ChangeLimit,
}

/// A play and a first-order lag in series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Response {
    /// Radius of the play, in units of 2⁻³² turns; 0: no play.
    pub play: i32,
    /// Share of the deviation that the lag follows by in one value, in units of 2⁻¹⁶; [`Response::PROMPT`]: no lag.
    pub share: i32,
}

impl Response {
    /// One in the units of the share.
    pub const PROMPT: i32 = 1 << 16;

    /// Neither play nor lag.
    pub const NONE: Self = Self { play: 0, share: Self::PROMPT };
}

impl CoupledSegment {
    /// One in the units of the ratio.
    pub const ONE: f64 = 268_435_456.0;
}
