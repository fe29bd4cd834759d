//! Configuration of contact detection.

use crate::numeric::phase::Turns;

/// Thresholds of contact detection for segments without [limits](ContactLimits) of their own: changes within five
/// values that a free arm does not reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactConfig {
    /// Threshold of the IMUs against the bend sensors of a segment, after a quarter of the motion is subtracted.
    pub bend: Turns,
    /// Threshold of a segment against the segment that it is coupled to.
    pub coupling: Turns,
}

/// An earlier segment that bends in proportion in free motion: θ = ratio · θ of that segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CoupledSegment {
    /// Its index in the table, from 0.
    pub segment: u8,
    /// Ratio of the bend angles, in units of 2⁻²⁸, within ±8.
    pub ratio: i32,
}

/// Contact detection of one segment by limits from the scatter of the calibration sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactLimits {
    /// Limit of the change of the IMUs against the bend sensors; `None`: this residual is not used.
    pub bend: Option<ChangeLimit>,
    /// Response to the coupled segment and limit of the change against it; `None`: this residual is not used.
    pub coupling: Option<Coupling>,
}

/// Limit of the change of a residual within a second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChangeLimit {
    /// Change that the free arm does not reach.
    pub change: Turns,
    /// Largest motion within half a second in the calibration sweep. A part of the excess over it is subtracted from
    /// the change.
    pub motion: Turns,
}

/// Coupling of a segment to an earlier one in free motion: the responses of both to the same pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coupling {
    /// Ratio of θ to that of the coupled segment where the latter is negative, in units of 2⁻²⁸, within ±8.
    pub ratio_left: i32,
    /// Play and lag applied to the coupled segment's angle before the comparison.
    pub lead: Response,
    /// Play and lag applied to the segment's own angle.
    pub own: Response,
    /// Limit of the change of the residual.
    pub limit: ChangeLimit,
}

/// A play and a first-order lag in series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
