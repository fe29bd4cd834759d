//! Contact detection.

pub(crate) mod coupling;
pub mod detector;
pub mod monitor;
