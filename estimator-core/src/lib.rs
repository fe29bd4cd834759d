//! The shape of a soft robot arm from its bend sensors and IMUs, without a camera.
//!
//! The method is that of arXiv 2511.01165: quadratic V–Orient maps turn bend-sensor voltages into bend angles, a
//! moving-average anchor removes the drift of the IMUs, two Kalman filters (KF_orient, KF_coord) fuse both, and
//! piecewise-constant-curvature kinematics (PCC) chain the segments to the arm's shape. `docs/explanation/paper.md` in the
//! repository lists where the paper's text errs and what is done here instead.
//!
//! The crate is `no_std`, does not allocate, and depends on no hardware, file or protocol. It is generic over its
//! number type ([`Scalar`]): a board without a float unit runs [`Q`], and a laptop that runs [`Q`] computes the same
//! bits.
//!
//! # The pipeline
//!
//! A sample passes through the stages in this order. Each stage is a module, and each equation is one function.
//!
//! | stage | equation | function |
//! |---|---|---|
//! | sensing | θ = c2 V² + c1 V + c0 (eq. 1), or a curve | [`BendMap::angle`] |
//! | | heading of a quaternion, unwrapped, tared | [`ImuReading::heading`], [`HeadingTracker`] |
//! | drift | offset_i = MA_W(θ_imu,i − θ_bend,i) (eq. 2, 3) | [`MovingAverageAnchor::push`] |
//! | | x⁻ = A x, P⁻ = A P Aᵀ + Q (process noise) | [`BiasState::predict`] |
//! | | ν = z − H x⁻ (innovation), K = P⁻Hᵀ/S, x = x⁻ + K ν | [`BiasState::innovation`], [`BiasState::update`] |
//! | fusion | KF_orient and KF_coord (eq. 8 to 12) | [`KalmanFilter::step`] |
//! | kinematics | PCC (eq. 4 to 6), forward kinematics (eq. 7) | [`Pcc::link`], [`forward_kinematics`] |
//! | | C = J P Jᵀ along the chain (Jacobian J) | [`CovariancePropagation::step`] |
//! | contact | contact detector: fast change of a residual | [`Estimator::contacts`] |
//!
//! [`ArmConfig`] selects the drift correction: the paper's moving average, or the bias filter.
//!
//! Units: rad, m and s; angles are clockwise positive (towards +x), headings count from the base's y axis.
//!
//! ```
//! use estimator_core::{Estimator, ImuReading, Method, Phase, Q, Sample, SegmentConfig, ArmConfig};
//!
//! // One segment of 80 mm with a 17 mm connector and no bend sensor; headings are absolute.
//! let segments = [SegmentConfig::<Q>::uncalibrated(0.080, 0.017)];
//! let table = ArmConfig::uncalibrated(&segments);
//! let mut estimator = Estimator::<Q, 1, 100>::new(&table)?;
//!
//! let mut sample = Sample::missing(0);
//! sample.imu[0] = Some(ImuReading::Heading(Phase::from_degrees(30.0)));
//! let estimate = estimator.update_full(&sample);
//! let tip = estimator.shape(&estimate, Method::ImuO)[0].end.expect("the IMU was read");
//! assert!((tip.x.to_f64() - 0.02897).abs() < 1e-5 && (tip.y.to_f64() - 0.09111).abs() < 1e-5);
//! # Ok::<(), estimator_core::ConfigError>(())
//! ```
//!
//! `examples/tip.rs` runs the pipeline on a host; `examples/no-std-table` is a `no_std` program with a calibration
//! table.
#![no_std]

mod config;
mod contact;
mod drift;
mod estimator;
mod fusion;
mod kinematics;
mod numeric;
mod segment;
mod sensing;
mod types;
mod uncertainty;

// Types of these crates are in public signatures.
pub use heapless;
pub use nalgebra;
pub use num_traits;

pub use config::{
    AnchorConfig, ArmConfig, BendErrorConfig, BendMap, BendSensorConfig, BiasFilterConfig, ChangeLimit, ConfigError,
    ContactConfig, ContactLimits, CoupledSegment, Coupling, CurveMap, KNOTS, KalmanParams, Lag, MemoryConfig, OffsetAt,
    PLAYS, Play, QuadraticMap, Response, SENSORS_PER_SEGMENT, SegmentConfig, UncertaintyConfig,
};
pub use drift::bias_filter::ABSENT_TIME_S;
pub use drift::bias_state::{BiasState, Innovation, LONGEST_PREDICTION_US, Row};
pub use drift::bias_trace::{BiasMeasurement, BiasOperation, BiasTrace};
pub use drift::decimator::{Decimated, Decimator};
pub use drift::moving_average::MovingAverageAnchor;
pub use drift::share::Share;
pub use drift::{CorrectedArm, DriftCorrection, MeasuredAngles, SensedArm};
pub use estimator::Estimator;
pub use fusion::kalman::{COVARIANCE_LIMIT, H_LIMIT, KalmanFilter, KalmanGains};
pub use kinematics::covariance::{CovariancePropagation, lever_arm};
pub use kinematics::forward::forward_kinematics;
pub use kinematics::pcc::{Pcc, SegmentPose, UnitArc};
pub use numeric::angle::Angle;
pub use numeric::fused::{FusedOps, plain};
pub use numeric::phase::{Phase, Turns};
pub use numeric::q::Q;
pub use numeric::saturation::saturations;
pub use numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
pub use numeric::variance::VARIANCE_SCALE;
pub use sensing::bend_map::VOLTS_PER_COUNT;
pub use sensing::bend_sensors::BendAngles;
pub use sensing::heading::{HeadingTracker, SegmentHeading};
pub use types::{
    Condition, Conditions, Contact, Contacts, Covariance, Estimate, ImuReading, Method, Sample, SegmentEstimate,
    SegmentShape, Shape, Uncertainties, Uncertainty,
};
pub use uncertainty::ShapeUncertainty;
