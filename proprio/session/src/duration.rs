//! Duration of a session that is simulated, recorded or driven.

/// Longest duration, s: four months.
const MAX_S: f64 = 1e7;

/// A duration out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("--seconds {0}, expected more than 0 and at most 10 million")]
pub struct DurationError(f64);

/// Checks a duration, s.
///
/// # Errors
/// [`DurationError`] outside 0 to 10⁷ s, and of 0 s.
pub fn check_seconds(seconds: f64) -> Result<(), DurationError> {
    if seconds > 0.0 && seconds <= MAX_S { Ok(()) } else { Err(DurationError(seconds)) }
}
