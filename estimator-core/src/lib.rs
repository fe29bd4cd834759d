//! The shape of a soft robot arm from its bend sensors and IMUs, without a camera.
//!
//! The method is that of arXiv 2511.01165: quadratic V–Orient maps turn bend-sensor voltages into bend angles, a
//! moving-average anchor takes the drift out of the IMUs, two Kalman filters (KF_orient, KF_coord) fuse both, and
//! piecewise-constant-curvature kinematics (PCC) chain the segments to the arm's shape. `docs/PAPER.md` in the
//! repository lists where the paper's text errs and what is done here instead.
//!
//! The crate is `no_std`, allocates nothing and knows no hardware, no file and no protocol. It is generic over its
//! number ([`Scalar`]): a board without a float unit runs [`Q`], and a laptop that runs [`Q`] gets the same bits.
//!
//! | module | what it is for |
//! |---|---|
//! | [`Sample`], [`ImuReading`] | what a board reads in one tick |
//! | [`Table`], [`Segment`] | an arm's geometry, maps and filter parameters |
//! | [`Estimator`], [`Estimate`], [`Method`] | one step of all four methods, and the shape by each |
//! | [`Arc`], [`Pcc`], [`Link`], [`chain`] | PCC kinematics |
//! | [`Heading`], [`Pace`], [`Anchor`], [`Block`] | the stages, usable by themselves |
//!
//! Units: rad, m and s; angles are clockwise positive (towards +x), headings count from the base's y axis.
//!
//! ```
//! use estimator_core::{Estimator, ImuReading, Method, Phase, Q, Sample, Segment, Table};
//!
//! // One segment of 80 mm with a 17 mm connector and no bend sensor; headings are absolute.
//! let segments = [Segment::<Q>::bare(0.080, 0.017)];
//! let table = Table::bare(&segments);
//! let mut estimator = Estimator::<Q, 1, 100>::new(&table)?;
//!
//! let mut sample = Sample::missing(0);
//! sample.imu[0] = Some(ImuReading::Heading(Phase::from_degrees(30.0)));
//! let estimate = estimator.step(&sample);
//! let tip = estimator.shape(&estimate, Method::ImuO)[0].end.expect("the IMU was read");
//! assert!((tip.x.to_f64() - 0.02897).abs() < 1e-5 && (tip.y.to_f64() - 0.09111).abs() < 1e-5);
//! # Ok::<(), estimator_core::TableError>(())
//! ```
#![no_std]

mod anchor;
mod angle;
mod bend;
mod beyond;
mod contact;
mod estimator;
mod filter;
mod fixed;
mod hysteresis;
mod imu;
mod observer;
mod overflow;
mod pcc;
mod q;
mod sample;
mod scalar;
mod state;
mod table;
mod uncertainty;

pub use anchor::{Anchor, AnchorRule, Pace, Slot};
pub use angle::{Angle, Phase, Turns};
pub use bend::{BendMap, VOLTS_PER_COUNT};
pub use contact::{Alike, Contact, ContactRule, Contacts};
pub use estimator::{Estimate, Estimator, Fused, Method, SegmentEstimate, Shape};
pub use filter::{Block, COVARIANCE_LIMIT, Gains, H_LIMIT, Noise};
pub use hysteresis::{Hysteresis, PLAYS, Play};
pub use imu::Heading;
pub use observer::{Disagreement, Observer, ObserverRule};
pub use overflow::saturations;
pub use pcc::{Arc, Link, Pcc, SegmentShape, chain};
pub use q::Q;
pub use sample::{ImuReading, SENSORS_PER_SEGMENT, Sample};
pub use scalar::{Constant, Scalar};
pub use table::{OffsetAt, Segment, Table, TableError};
pub use uncertainty::{Covariance, SCALE, Spread, Uncertainties, Uncertainty, UncertaintyRule};
