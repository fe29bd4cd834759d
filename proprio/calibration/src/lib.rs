//! Tables from recorded sessions: calibration on a sweep with camera truth, tuning, and alignment of a camera's clock.

pub mod align;
pub mod calibrate;
mod error;
pub mod tune;

pub use error::Error;
