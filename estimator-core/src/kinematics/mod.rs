//! Kinematics: constant curvature, the chain of the segments, and the covariance along it.

pub mod covariance;
pub mod forward;
pub mod pcc;
