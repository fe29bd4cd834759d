//! Input and output of a drift correction.

use crate::config::ArmConfig;
use crate::drift::decimator::Decimated;
use crate::drift::share::Share;
use crate::numeric::phase::Turns;
use crate::sensing::bend_sensors::BendAngles;
use crate::sensing::heading::SegmentHeading;

/// Bend angles and headings of one sample, from the base to the tip.
#[derive(Debug, Clone, Copy)]
pub struct SensedArm<S, const N: usize> {
    /// Time of the sample, µs.
    pub time_us: u64,
    /// Position of the sample between two values of the anchor.
    pub decimated: Decimated,
    /// Share of the work on covariances that belongs to the sample.
    pub share: Share,
    /// Bend angles.
    pub bend: [BendAngles<S>; N],
    /// Headings of the segments' ends.
    pub headings: [SegmentHeading; N],
}

impl<S, const N: usize> SensedArm<S, N> {
    /// Before the first sample.
    pub const UNKNOWN: Self = Self {
        time_us: 0,
        decimated: Decimated { oldest: 0, complete: 0 },
        share: Share::Whole,
        bend: [const { BendAngles::UNKNOWN }; N],
        headings: [SegmentHeading::BASE; N],
    };
}

/// Corrected bend angles of one sample, from the base to the tip.
#[derive(Debug, Clone, Copy)]
pub struct CorrectedArm<const N: usize> {
    /// θ_c,i of the IMUs; `None` where one of the two was not read, or is not trusted.
    pub imu: [Option<Turns>; N],
    /// θ_i of all sensors; `None` where KF_orient and KF_coord fuse them.
    pub fused: [Option<Turns>; N],
    /// Angles for the contact detector.
    pub measured: [MeasuredAngles; N],
}

/// Bend angles of one segment for the contact detector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MeasuredAngles {
    /// θ_c,i without `steps`; `None` where one of the two IMUs was not read, or is not trusted.
    pub imu: Option<Turns>,
    /// Sum of the steps of θ_c,i that updates of the bias have caused: no motion of the segment.
    pub steps: Turns,
    /// θ_bend of the trusted sensors; `None` without any.
    pub bend: Option<Turns>,
}

impl MeasuredAngles {
    /// No angle is known.
    pub const UNKNOWN: Self = Self { imu: None, steps: Turns::ZERO, bend: None };
}

impl<const N: usize> CorrectedArm<N> {
    /// No angle is known.
    pub const UNKNOWN: Self = Self { imu: [None; N], fused: [None; N], measured: [MeasuredAngles::UNKNOWN; N] };
}

/// Removes the drift from the IMUs' bend angles.
pub trait DriftCorrection<S, const N: usize> {
    /// Corrects the angles of one sample, in place.
    fn correct(&mut self, config: &ArmConfig<S>, sensed: &SensedArm<S, N>, corrected: &mut CorrectedArm<N>);
}
