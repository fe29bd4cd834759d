//! Contact detection.

pub mod detector;
pub mod monitor;
