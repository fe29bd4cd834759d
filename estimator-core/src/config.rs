//! Configuration of an arm: types alone, in the estimator's number and for one sample rate.
//!
//! The firmware holds an [`ArmConfig`] as a constant; on the host `calibration-tables` makes it from TOML. Variances
//! are stored multiplied by [`VARIANCE_SCALE`](crate::VARIANCE_SCALE), times in units of [`TIME_UNIT_S`](crate::TIME_UNIT_S).

mod contact;

use crate::numeric::phase::Turns;
use crate::numeric::q::Q;
use crate::numeric::scalar::{Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, variance_deg};

pub use contact::{ChangeLimit, ContactConfig, ContactLimits, CoupledSegment, Coupling, Response};

/// Bend sensors that a segment can carry: `a` and `b`.
pub const SENSORS_PER_SEGMENT: usize = 2;

/// Plays of a segment's hysteresis compensation.
pub const PLAYS: usize = 3;

/// Knots of a [`CurveMap`].
pub const KNOTS: usize = 65;

/// An arm's calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmConfig<'t, S> {
    /// The segments from the base to the tip.
    pub segments: &'t [SegmentConfig<S>],
    /// Number of samples at the start over which headings are tared; 0: headings are absolute.
    pub tare_samples: u32,
    /// The moving-average anchor; contact detection runs at its rate, too.
    pub anchor: AnchorConfig,
    /// The bias filter; `None`: the moving-average anchor corrects the drift.
    pub bias_filter: Option<BiasFilterConfig>,
    /// Contact-detection thresholds; `None` disables detection.
    pub contact: Option<ContactConfig>,
    /// Error sources of the estimates; `None`: no covariance is computed.
    pub uncertainty: Option<UncertaintyConfig>,
}

/// One sensing segment: geometry, sensors and filter parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SegmentConfig<S> {
    /// Arc length of the curved part, L_act, m.
    pub length: S,
    /// Length of the rigid connector, d_off, m.
    pub offset: S,
    /// Side of the connector.
    pub offset_at: OffsetAt,
    /// The bend sensors a and b, where the segment has them.
    pub bend: [Option<BendSensorConfig<S>>; SENSORS_PER_SEGMENT],
    /// Hysteresis compensation of the segment's bend angle, if any.
    pub hysteresis: Option<[Play<S>; PLAYS]>,
    /// Errors of the bend sensors, as the bias filter models them.
    pub bend_error: BendErrorConfig,
    /// Sensitivity of the IMU's heading as a factor minus 1, in units of 2⁻³²: 0.01 reads 1 % too much.
    pub imu_scale_error: i32,
    /// The earlier segment that this one is coupled to, if any.
    pub coupled_to: Option<CoupledSegment>,
    /// Limits of contact detection; `None`: the thresholds of the arm.
    pub contact: Option<ContactLimits>,
    /// Heading of the segment's end in the reference pose.
    pub reference: Turns,
    /// KF_orient's parameters.
    pub orient: KalmanParams<S>,
    /// KF_coord's parameters.
    pub coord: KalmanParams<S>,
}

/// Position of a segment's rigid connector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OffsetAt {
    /// It precedes the curved part.
    Start,
    /// It follows the curved part.
    End,
}

/// One bend sensor: V–Orient map and memory.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BendSensorConfig<S> {
    /// Bend angle of the counts.
    pub map: BendMap<S>,
    /// Compensation of creep and hysteresis, if any.
    pub memory: Option<MemoryConfig<Q>>,
}

/// V–Orient map of one bend sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BendMap<S> {
    /// The paper's quadratic.
    Quadratic(QuadraticMap<S>),
    /// A piecewise linear curve.
    Curve(CurveMap<S>),
}

/// Quadratic map about the middle of the sensor's own voltage range: θ = b0 + b1 u + b2 u² with
/// u = (counts − `center`) / 2^`shift` within ±1.
///
/// In this form the coefficients are no larger than the angles; c2, c1 and c0 of a sensor with a narrow range are large
/// and cancel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct QuadraticMap<S> {
    /// Counts in the middle of the calibrated range.
    pub center: u16,
    /// Binary logarithm of half the range in counts, rounded up.
    pub shift: u8,
    /// b0, b1, b2, rad.
    pub coefficients: [S; 3],
    /// Lowest and highest counts at which |θ| is within a whole turn, and u and b1 + b2 u in the range of
    /// [`FusedOps::eval_quadratic`](crate::FusedOps::eval_quadratic).
    pub readable: [u16; 2],
}

/// Piecewise linear map: knots every 2^`shift` counts from `first` on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(serialize = "S: serde::Serialize", deserialize = "S: serde::Deserialize<'de>"))
)]
pub struct CurveMap<S> {
    /// Counts of the first knot.
    pub first: u16,
    /// Binary logarithm of the counts between two knots.
    pub shift: u8,
    /// Bend angle at each knot, rad.
    #[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))]
    pub knots: [S; KNOTS],
    /// Lowest and highest valid counts.
    pub readable: [u16; 2],
    /// Lowest and highest counts of the calibration sweep; outside them the curve is extrapolated.
    pub calibrated: [u16; 2],
}

/// Creep and hysteresis of one bend sensor: θ + Σ w (θ − lag(θ)) + Σ w (θ − play(θ)).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MemoryConfig<S> {
    /// First-order lags.
    pub lags: [Lag<S>; 2],
    /// Plays.
    pub plays: [Play<S>; 2],
}

/// A first-order lag and its share in the correction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lag<S> {
    /// Time constant, units of [`TIME_UNIT_S`](crate::TIME_UNIT_S).
    pub time: S,
    /// One over it.
    pub rate: S,
    /// Weight of the difference of input and lag.
    pub weight: S,
}

/// A play operator and its share in the correction (Kuhnen 2003, eq. 2).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Play<S> {
    /// Radius r: from the middle to either edge, rad.
    pub radius: S,
    /// Weight of the difference of input and play.
    pub weight: S,
}

/// Errors of a segment's bend sensors, from the residuals of the calibration sweep.
///
/// The error is a function of the path (map, hysteresis), not white in time: it decorrelates after a travel of
/// `travel`, or after `correlation_time`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BendErrorConfig {
    /// Variance of the mean of both sensors, σ².
    pub mean: Q,
    /// Variance of each sensor, σ₁².
    pub sensor: [Q; SENSORS_PER_SEGMENT],
    /// Threshold of a step: change of a sensor from one sample to the next, rad.
    pub step: Q,
    /// Variance of half the difference of a and b, σ_d².
    pub difference: Q,
    /// Standard deviation of 60 s means of half that difference, rad.
    pub slow_difference: Q,
    /// Variance of the mean's slow error over that of half the difference, κ, 0 to 1.
    pub slow_ratio: Q,
    /// Correlation length ℓ: travel after which the error is independent, rad.
    pub travel: Q,
    /// Correlation time τ, after which the error is independent, units of [`TIME_UNIT_S`](crate::TIME_UNIT_S).
    pub correlation_time: Q,
}

/// Window, rates and threshold of the moving-average anchor; the same for all segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AnchorConfig {
    /// Length of the window, in values.
    pub window: u16,
    /// Rate of the window's values, mHz. Above the sample rate, every sample is a value.
    pub rate_millihertz: u32,
    /// Rate of the samples, mHz; those between two values are averaged.
    pub sample_rate_millihertz: u32,
    /// Offsets up to this size are not applied.
    pub threshold: Turns,
}

/// Priors and process noise of the bias filter; the same for all IMUs and segments. All but the last are variances.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BiasFilterConfig {
    /// Prior of each heading's bias at the end of the tare, rad².
    pub initial_bias: Q,
    /// Prior of each segment's bend angle in the reference pose, rad².
    pub straightness: Q,
    /// Prior of the bias's rate (turn-on bias of the gyroscope), (rad per time unit)².
    pub initial_rate: Q,
    /// Process noise of the bias (angle random walk), rad² per time unit.
    pub bias_noise: Q,
    /// Process noise of the rate (rate random walk), (rad per time unit)² per time unit.
    pub rate_noise: Q,
    /// Prior of the offset of a segment's bend sensors in a session, rad².
    pub offset: Q,
    /// [`TIME_UNIT_S`](crate::TIME_UNIT_S) over the time constant of the offset (a Gauss–Markov process).
    pub offset_rate: Q,
}

/// Error sources of the shape; the same for all segments.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct UncertaintyConfig {
    /// Variance of θ behind the moving-average anchor, rad².
    pub theta: Q,
    /// Factor on the bias filter's covariance, which is conservative.
    pub bias_share: Q,
    /// Variance of θ that bend sensors alone measure, rad².
    pub bend: Q,
    /// Variance that a contact adds to θ, rad².
    pub contact: Q,
    /// Variance of each heading's own error, rad². It enters θ of this segment and of the next with opposite signs.
    pub heading: Q,
    /// Variance of either coordinate of a segment's end in its own frame, at any bend angle, m².
    pub end: Q,
}

/// Parameters of one scalar filter of KF_orient or KF_coord. The gains depend on ratios of covariances alone, so all
/// are given as ratios to the larger of R_imu and R_bend, which keeps them within [`Q`]'s range.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct KalmanParams<S> {
    /// Process noise Q from one sample to the next.
    pub q: S,
    /// Measurement noise R of the drift-corrected IMU.
    pub r_imu: S,
    /// Measurement noise R of the bend sensors.
    pub r_bend: S,
    /// Measurement matrix H of the drift-corrected IMU.
    pub h_imu: S,
    /// Measurement matrix H of the bend sensors.
    pub h_bend: S,
}

impl BendErrorConfig {
    /// Errors of sensors without a calibration sweep: the paper's mean of 4.72° for each, independent of each other.
    pub const PAPER: Self = Self {
        mean: variance_deg(3.34).q,
        sensor: [variance_deg(4.72).q; SENSORS_PER_SEGMENT],
        step: degrees(6.0).q,
        difference: variance_deg(3.34).q,
        slow_difference: degrees(1.5).q,
        slow_ratio: Q::from_f64(1.0),
        travel: degrees(60.0).q,
        correlation_time: Q::from_f64(10.0 / TIME_UNIT_S),
    };
}

impl BiasFilterConfig {
    /// Priors and noise of BNO055 units in IMUPLUS mode and of flex sensors (`docs/explanation/drift.md` has the sources).
    pub const BNO055: Self = Self {
        initial_bias: variance_deg(0.1).q,
        straightness: variance_deg(0.3).q,
        // 0.05 °/s: the paper's worst unit turns by 45° in 15 min.
        initial_rate: variance_deg(0.05 * TIME_UNIT_S).q,
        // 0.01 °/√s and 2e-4 °/s/√s, over a time unit of 64 s.
        bias_noise: variance_deg(0.01 * 8.0).q,
        rate_noise: variance_deg(2e-4 * TIME_UNIT_S * 8.0).q,
        offset: variance_deg(1.0).q,
        offset_rate: Q::from_f64(TIME_UNIT_S / 1500.0),
    };
}

impl<S: Scalar> SegmentConfig<S> {
    /// A segment without bend sensors: `length` and `offset` in m, connector at the end, straight at rest.
    #[must_use]
    pub fn uncalibrated(length: f64, offset: f64) -> Self {
        let unit = KalmanParams { q: S::one(), r_imu: S::one(), r_bend: S::one(), h_imu: S::one(), h_bend: S::one() };
        Self {
            length: S::from_f64(length),
            offset: S::from_f64(offset),
            offset_at: OffsetAt::End,
            bend: [None; SENSORS_PER_SEGMENT],
            hysteresis: None,
            bend_error: BendErrorConfig::PAPER,
            imu_scale_error: 0,
            coupled_to: None,
            contact: None,
            reference: Turns::ZERO,
            orient: unit,
            coord: unit,
        }
    }
}

impl<'t, S> ArmConfig<'t, S> {
    /// An arm with absolute headings and the paper's anchor at 10 Hz: 10 s, 0.5°.
    #[must_use]
    pub const fn uncalibrated(segments: &'t [SegmentConfig<S>]) -> Self {
        // 0.5° in units of 2⁻³² turns.
        let anchor = AnchorConfig {
            window: 100,
            rate_millihertz: 10_000,
            sample_rate_millihertz: 10_000,
            threshold: Turns::from_bits(5_965_232),
        };
        Self { segments, tare_samples: 0, anchor, bias_filter: None, contact: None, uncertainty: None }
    }
}

/// Reason why an [`Estimator`](crate::Estimator) rejects a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConfigError {
    /// The arm has no segment, or more than the estimator was built for.
    Segments {
        /// Segments of the arm.
        found: usize,
        /// Segments that the estimator has room for.
        room: usize,
    },
    /// The anchor's window is empty, or longer than the estimator was built for.
    Window {
        /// Length of the window.
        found: u16,
        /// Length that the estimator has room for.
        room: usize,
    },
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Segments { found, room } => write!(f, "the table has {found} segments, expected 1 to {room}"),
            Self::Window { found, room } => write!(f, "the anchor's window is {found} values, expected 1 to {room}"),
        }
    }
}

impl core::error::Error for ConfigError {}
