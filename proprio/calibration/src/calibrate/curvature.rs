//! Error of constant curvature: the true ends of the segments against those that the true bend angles give.

use estimator_core::{Angle, Pcc, SegmentConfig, forward_kinematics};
use nalgebra::Vector2;
use proprio_session::Row;

/// Largest distance of the true tip from the chain of the true headings that constant curvature explains, % of the arm's
/// length: a real arm has 3 %.
pub(crate) const MISFIT_PERCENT: f64 = 10.0;

/// Distance of the true tip from the chain of the true bend angles, m.
pub(crate) fn constant_curvature_error(row: &Row, segments: &[SegmentConfig<f64>]) -> Option<f64> {
    let thetas = segments.iter().enumerate().map(|(i, segment)| (row.true_theta(i), segment));
    let links = thetas.map(|(theta, segment)| theta.map(|theta| Pcc::new(segment).link(Angle::from(theta))));
    let tip = forward_kinematics(links).last()?.end?;
    let truth = row.truth.get(segments.len() - 1)?.as_ref()?;
    Some((tip - Vector2::new(truth.x_m, truth.y_m)).norm())
}

/// True end of a segment less that of constant curvature with the true bend angle, in the segment's own frame, m.
pub(super) fn end_error(row: &Row, i: usize, segment: &SegmentConfig<f64>) -> Option<Vector2<f64>> {
    let end = row.truth[i]?;
    let (x_m, y_m, heading) = match i.checked_sub(1) {
        Some(before) => {
            let before = row.truth[before]?;
            (before.x_m, before.y_m, before.heading_rad?)
        }
        None => (0.0, 0.0, 0.0),
    };
    let (dx, dy) = (end.x_m - x_m, end.y_m - y_m);
    let (sin, cos) = (libm::sin(heading), libm::cos(heading));
    let local = Vector2::new(cos * dx - sin * dy, sin * dx + cos * dy);
    Some(local - Pcc::new(segment).link(Angle::from(row.true_theta(i)?)).end)
}
