//! Unwrapping of headings.

use std::f64::consts::TAU;

/// The same direction, at most half a turn from `reference_rad`, rad.
pub(super) fn unwrap_near(heading_rad: f64, reference_rad: f64) -> f64 {
    heading_rad - TAU * ((heading_rad - reference_rad) / TAU).round()
}
