//! Error sources of the estimates.
//!
//! Their parameters are those of the reference arm, but for those that a sweep determines: the errors of the bend sensors, and
//! the error of constant curvature.

use calibration_tables::{ArmFile, SegmentToml, UncertaintyToml};
use serde::de::IgnoredAny;

use super::statistics::{quantile, rms};
use super::sweep::{MeanSquare, Sweep};

/// Share of the bend sensors' error that the moving-average anchor passes on to θ.
const ANCHORED_SHARE: f64 = 0.4;
/// Standard deviation of each heading behind the bias filter: its quantisation and its lag.
const HEADING_DEG: f64 = 0.2;
/// Standard deviation of θ that a contact adds, behind the anchor.
const CONTACT_DEG: f64 = 1.0;
/// Share of the tip's error of constant curvature that the angles' deviations do not cover, behind the anchor.
const END_SHARE: f64 = 0.9;

/// Sets `[uncertainty]` of a table whose maps and filters are set.
pub(super) fn set(sweep: &Sweep, table: &mut ArmFile) {
    let bend_deg = bend_deg(&table.segments);
    let is_filtered = table.bias_filter().is_some();
    let deviations = UncertaintyToml {
        theta_deg: ANCHORED_SHARE * bend_deg,
        bias_share: UncertaintyToml::bias_share(),
        retired: IgnoredAny,
        bend_deg,
        contact_deg: CONTACT_DEG,
        heading_deg: if is_filtered { HEADING_DEG } else { 0.0 },
        end_mm: if is_filtered { end_mm(sweep) } else { anchored_end_mm(sweep) },
    };
    // Clamped to the range of the format.
    table.uncertainty = Some(deviations.scaled(1.0));
}

/// Error of constant curvature at a segment's end in its own frame, mm: the median segment's, of both coordinates together.
fn end_mm(sweep: &Sweep) -> f64 {
    let mut ends: Vec<f64> = sweep.ends.iter().filter_map(MeanSquare::rms).collect();
    ends.sort_unstable_by(f64::total_cmp);
    if ends.is_empty() { 0.0 } else { quantile(&ends, 0.5) * 1000.0 }
}

/// The same from the arm's tip, to which both coordinates of all segments add up.
fn anchored_end_mm(sweep: &Sweep) -> f64 {
    END_SHARE * sweep.tip.rms().unwrap_or(0.0) * 1000.0 / (2.0 * sweep.theta.len() as f64).sqrt()
}

/// Root mean square error of the bend sensors, over the segments that have any.
fn bend_deg(segments: &[SegmentToml]) -> f64 {
    let of_segment = |segment: &SegmentToml| {
        let of_filter = segment.orient.as_ref().map(|noise| noise.r_bend.sqrt().to_degrees());
        of_filter.or(segment.bend_error.as_ref().map(|error| error.mean_deg))
    };
    rms(segments.iter().filter_map(of_segment))
}
