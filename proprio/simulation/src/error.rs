//! Errors of a simulated session.

use proprio_session::DurationError;
use rig_twin::FaultError;

/// A session that cannot be simulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// A rate that the arm cannot be sampled at.
    #[error("--rate {0} Hz, expected 1 to 1000")]
    Rate(f64),
    /// A duration out of range.
    #[error(transparent)]
    Seconds(#[from] DurationError),
    /// A fault that the arm's sensors cannot have.
    #[error(transparent)]
    Fault(#[from] FaultError),
}
