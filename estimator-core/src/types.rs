//! Inputs and outputs of the estimator: samples, estimates, shapes, covariances and contacts.

use heapless::Vec;
use nalgebra::Vector2;

use crate::config::SENSORS_PER_SEGMENT;
use crate::kinematics::pcc::SegmentPose;
use crate::numeric::angle::Angle;
use crate::numeric::phase::Phase;
use crate::numeric::q::Q;
use crate::numeric::variance::VARIANCE_SCALE;

/// Raw readings of one tick, for an arm of up to `N` segments. A missing reading is `None`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const N: usize> {
    /// Time of the tick, µs.
    pub time_us: u64,
    /// Raw ADC counts, 0…4095, of each segment's bend sensors a and b.
    pub bend: [[Option<u16>; SENSORS_PER_SEGMENT]; N],
    /// Raw reading of the IMU at each segment's end.
    pub imu: [Option<ImuReading>; N],
}

impl<const N: usize> Sample<N> {
    /// A sample at `time_us` without readings.
    #[must_use]
    pub const fn missing(time_us: u64) -> Self {
        Self { time_us, bend: [[None; SENSORS_PER_SEGMENT]; N], imu: [None; N] }
    }
}

/// The raw orientation of one IMU, mounted z up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImuReading {
    /// The heading alone.
    Heading(Phase),
    /// A unit quaternion w, x, y, z in units of 2⁻³⁰.
    Quaternion([i32; 4]),
}

impl ImuReading {
    /// Converts from a BNO055's quaternion registers w, x, y, z in units of 2⁻¹⁴ (datasheet 3.6.5.5). Exact.
    #[must_use]
    pub const fn from_bno055([w, x, y, z]: [i16; 4]) -> Self {
        Self::Quaternion([(w as i32) << 16, (x as i32) << 16, (y as i32) << 16, (z as i32) << 16])
    }
}

/// Method by which the shape is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Bend sensors alone.
    Bend,
    /// Raw IMUs, without drift correction (the paper's IMU_O).
    ImuO,
    /// Drift-corrected IMUs (the paper's IMU_C).
    ImuC,
    /// All sensors.
    Fusion,
}

impl Method {
    /// All methods, in the order of the files' columns.
    pub const ALL: [Self; 4] = [Self::Bend, Self::ImuO, Self::ImuC, Self::Fusion];

    /// The method's name in files: `bend`, `imu_o`, `imu_c`, `fusion`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bend => "bend",
            Self::ImuO => "imu_o",
            Self::ImuC => "imu_c",
            Self::Fusion => "fusion",
        }
    }
}

/// Estimate of one segment by every method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentEstimate<S> {
    /// Estimate from the bend sensors that were read.
    pub bend: Option<SegmentPose<S>>,
    /// θ_imu,i from the raw IMUs; `None` until the tare is complete.
    pub imu_o: Option<Angle<S>>,
    /// Estimate from the drift-corrected IMUs.
    pub imu_c: Option<SegmentPose<S>>,
    /// Estimate from all sensors: θ_i of KF_orient and P_i of KF_coord, or of the bias filter; `None` before the first
    /// measurement.
    pub fusion: Option<SegmentPose<S>>,
    /// Number of the segment's bend sensors that were read.
    pub bend_sensors_read: u8,
    /// The segment's IMU returned a valid heading.
    pub imu_read: bool,
}

/// Estimate of the arm at one sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate<S, const N: usize> {
    /// Time of the sample, µs.
    pub time_us: u64,
    /// The segments from the base to the tip.
    pub segments: Vec<SegmentEstimate<S>, N>,
}

/// One segment of the arm's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentShape<S> {
    /// Bend angle θ_i.
    pub theta: Option<Angle<S>>,
    /// End of the segment in {W}, m.
    pub end: Option<Vector2<S>>,
}

/// The arm's shape by one method, from the base to the tip.
pub type Shape<S, const N: usize> = Vec<SegmentShape<S>, N>;

/// Covariance of a world point, [`VARIANCE_SCALE`] times m².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Covariance {
    /// Variance of x.
    pub xx: Q,
    /// Covariance of x and y.
    pub xy: Q,
    /// Variance of y.
    pub yy: Q,
}

impl Covariance {
    /// xx, xy and yy in m². For reports.
    #[must_use]
    pub fn square_metres(self) -> [f64; 3] {
        [self.xx, self.xy, self.yy].map(|value| value.to_f64() / VARIANCE_SCALE)
    }
}

/// Uncertainty of one segment of the fused shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Variance of θ_i, [`VARIANCE_SCALE`] times rad²; `None` where nothing was measured.
    pub theta: Option<Q>,
    /// Covariance of the segment's end in {W}; `None` from the first unknown angle on.
    pub end: Option<Covariance>,
}

/// Uncertainty of the fused shape, from the base to the tip.
pub type Uncertainties<const N: usize> = Vec<Uncertainty, N>;

/// Conditions of one segment that degrade its estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "independent conditions")]
pub struct Condition {
    /// The arm was bent or moving in the tare: the bend sensors set the zeros of the IMUs.
    pub tare_bad: bool,
    /// The IMU is not read, frozen, or reads an implausible heading.
    pub imu_absent: bool,
    /// The IMU has had a new zero within the last minute, or may have: it was absent.
    pub imu_restarted: bool,
    /// A bend sensor is missing or excluded, or has had a new zero within the last minute.
    pub bend_distrusted: bool,
    /// The innovation gate rejects the bend sensors: they disagree with the IMUs.
    pub gated: bool,
    /// The IMU is read, but its heading is implausible or frozen: a part of [`imu_absent`](Self::imu_absent).
    pub imu_implausible: bool,
    /// Bend sensors a and b are read, but excluded, outside their calibration, or had a new zero within the last minute: a
    /// part of [`bend_distrusted`](Self::bend_distrusted).
    pub bend_implausible: [bool; SENSORS_PER_SEGMENT],
}

impl Condition {
    /// Returns `true` if any of the conditions holds.
    #[must_use]
    pub const fn is_degraded(self) -> bool {
        self.tare_bad || self.imu_absent || self.imu_restarted || self.bend_distrusted || self.gated
    }
}

/// Conditions of the segments, from the base to the tip.
pub type Conditions<const N: usize> = Vec<Condition, N>;

/// Contact of one segment and its score.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contact {
    /// Largest change of the residual within half a second, in percent of the threshold.
    pub score_percent: u16,
    /// Contact: from a score over 100 until the change has reverted, a minute at most.
    pub in_contact: bool,
}

/// Contacts of the segments, from the base to the tip.
pub type Contacts<const N: usize> = Vec<Contact, N>;
