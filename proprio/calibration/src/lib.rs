//! Tables from recorded sessions: calibration on a sweep with camera truth, coverage of that sweep while it is made, tuning, and
//! alignment of a camera's clock.

pub mod align;
pub mod calibrate;
pub mod coverage;
mod error;
mod truth;
mod truth_error;
pub mod tune;

pub use error::Error;
pub use truth::JudgedTruth;
pub use truth_error::{TruthError, TruthLengths};
