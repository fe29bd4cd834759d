//! Smooth transition between two values.

/// Cubic from 0 at `share` 0 to 1 at 1, with zero slope at both ends; constant outside.
pub(crate) fn smooth_step(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
