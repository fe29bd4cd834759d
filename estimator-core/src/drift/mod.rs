//! Drift correction of the IMUs: the paper's moving-average anchor, and a Kalman filter over the biases of all
//! headings.

pub mod bend_monitor;
pub mod bias_filter;
pub mod bias_state;
pub mod bias_trace;
pub mod correction;
pub mod decimator;
pub mod heading_gate;
pub mod moving_average;
pub mod rest;
pub mod share;

pub use correction::{CorrectedArm, DriftCorrection, MeasuredAngles, SensedArm};
