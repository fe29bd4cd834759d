//! What a sweep has covered so far, and what a calibration needs.

use proprio_check::TARE_MOVES_DEG;
use serde::Serialize;

use super::fault::SweepFault;
use crate::calibrate::{GOOD_RANGE_DEG, LEAST_RANGE_DEG};

/// What a sweep has covered so far.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepReport {
    /// Its duration without gaps, s.
    pub seconds: f64,
    /// The IMU that turned most in the first second, which is the tare of the session; `None` before, or without an IMU.
    pub rest: Option<Rest>,
    /// Segments from the base to the tip.
    pub segments: Vec<SegmentCoverage>,
    /// Pairs of segments, from 1, that have bent alike but for a factor.
    pub coupled: Vec<[usize; 2]>,
    /// Sensors that do not follow.
    #[serde(skip)]
    pub faults: Vec<SweepFault>,
    /// What the sweep should reach.
    pub goal: SweepGoal,
}

/// The pose at the begin of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rest {
    /// The segment, from 1, whose IMU turned most.
    pub segment: usize,
    /// By how much, degrees.
    pub turned_deg: f64,
}

/// What a segment has gone through.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SegmentCoverage {
    /// Smallest and largest bend angle by the IMUs at both its ends, from the pose at the begin of the sweep, degrees; `None`
    /// where one of them was not read.
    pub ends_deg: Option<[f64; 2]>,
    /// The bend angle in the last row.
    pub now_deg: Option<f64>,
    /// The parts of that range in which it was for half a second or longer.
    pub seen_deg: Vec<[f64; 2]>,
    /// Ways from one end of the range to the other.
    pub passes: u32,
    /// Smallest and largest reading of bend sensors a and b, counts; `None` of one that was not read.
    pub counts: [Option<[u16; 2]>; 2],
}

/// What a sweep should reach.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SweepGoal {
    /// Duration, s.
    pub seconds: f64,
    /// Passes of each segment: there and back in each tenth of the sweep, as each tenth is predicted from the others.
    pub passes: u32,
    /// Turn of an IMU in the first second from which on the tare is bad, degrees.
    pub still_deg: f64,
    /// Range of bending below which `calibrate` refuses the sweep, degrees.
    pub least_range_deg: f64,
    /// Range of bending below which it warns, degrees.
    pub good_range_deg: f64,
}

impl SweepGoal {
    /// What [`calibrate`](crate::calibrate::calibrate) needs.
    pub(super) const CALIBRATE: Self = Self {
        seconds: 600.0,
        passes: 20,
        still_deg: TARE_MOVES_DEG,
        least_range_deg: LEAST_RANGE_DEG,
        good_range_deg: GOOD_RANGE_DEG,
    };
}
