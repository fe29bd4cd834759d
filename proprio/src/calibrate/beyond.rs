//! What goes beyond the paper: contact, and how far an estimate may be off.
//!
//! Their parameters are those of the reference arm, but for what a sweep shows of its own: which segments bend alike, how
//! wrong bend sensors are, and how far constant curvature is from the truth.

use calibration_tables::{ArmFile, CoupledKeys, RATIO_RANGE, SegmentKeys, UncertaintyKeys};

use super::sweep::Sweep;

/// Deviation of θ beside what is known of the drift. The anchor passes on what lasts of the bend sensors' error,
const OBSERVED_DEG: f64 = 0.1;
/// which is this share of it.
const ANCHORED_SHARE: f64 = 0.4;
/// Deviation of each heading behind the observer: its gyroscope's sensitivity. The anchor follows it.
const HEADING_DEG: f64 = 0.55;
/// Deviation of θ that a touch adds.
const CONTACT_DEG: f64 = 1.0;
/// Share of the sweep's distance from constant curvature that the angles' deviations do not cover.
const END_SHARE: f64 = 0.9;

/// Sets them for a table whose maps and filters are set. `misfit_m` is the distance of the true tip from constant curvature.
pub(super) fn set(sweep: &Sweep, misfit_m: f64, table: &mut ArmFile) {
    let is_observed = table.bias_filter().is_some();
    let bend_deg = bend_deg(&table.segments);
    let deviations = UncertaintyKeys {
        theta_deg: if is_observed { OBSERVED_DEG } else { ANCHORED_SHARE * bend_deg },
        bias_share: UncertaintyKeys::bias_share(),
        retired: Default::default(),
        bend_deg,
        contact_deg: CONTACT_DEG,
        heading_deg: if is_observed { HEADING_DEG } else { 0.0 },
        // Both coordinates of all segments add up to it.
        end_mm: END_SHARE * misfit_m * 1000.0 / (2.0 * table.segments.len() as f64).sqrt(),
    };
    // As far as the format goes.
    table.uncertainty = Some(deviations.scaled(1.0));
    table.contact.get_or_insert_default();
    for segment in &mut table.segments {
        segment.coupled_to = None;
    }
    for like in sweep.alike().iter().filter(|like| RATIO_RANGE.contains(&like.ratio)) {
        let alike = &mut table.segments[like.second - 1].coupled_to;
        alike.get_or_insert(CoupledKeys { segment: like.first, ratio: like.ratio });
    }
}

/// Root mean square error of the bend sensors, over the segments that have any.
fn bend_deg(segments: &[SegmentKeys]) -> f64 {
    let variances = || segments.iter().filter_map(|segment| segment.orient.as_ref()).map(|noise| noise.r_bend);
    (variances().sum::<f64>() / variances().count().max(1) as f64).sqrt().to_degrees()
}
