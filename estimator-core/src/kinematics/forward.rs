//! Forward kinematics: the chain of the segments from the base to the tip (paper, eq. 7, corrected in
//! `docs/explanation/paper.md`).

use nalgebra::Vector2;

use crate::kinematics::pcc::{SegmentPose, sin_cos};
use crate::numeric::fused::FusedOps;
use crate::types::SegmentShape;

/// Chains links from the base on: P_W,i = P_W,i−1 + R(Θ_i−1) P_i, where R(α) maps (x, y) to
/// (x cos α + y sin α, −x sin α + y cos α). From the first unknown link on, every end is unknown.
///
/// ```
/// use estimator_core::{Angle, Pcc, forward_kinematics, SegmentConfig};
///
/// let segments = [SegmentConfig::uncalibrated(0.080, 0.017), SegmentConfig::uncalibrated(0.080, 0.017)];
/// let straight = segments.iter().map(|segment| Some(Pcc::<f64>::new(segment).link(Angle::from(0.0))));
/// let tip = forward_kinematics(straight).last().and_then(|segment| segment.end).expect("all links are known");
/// assert!(tip.x == 0.0 && (tip.y - 0.194).abs() < 1e-12);
/// ```
#[inline]
pub fn forward_kinematics<S: FusedOps>(
    links: impl Iterator<Item = Option<SegmentPose<S>>>,
) -> impl Iterator<Item = SegmentShape<S>> {
    // Products of cosines and sines instead of the sum of the angles: no trigonometry, and nothing to wrap.
    let mut before = Some((Vector2::zeros(), (S::zero(), S::one())));
    links.map(move |link| {
        before = before.zip(link).map(|((point, (sin, cos)), link)| {
            let (x, y) = S::rotate_clockwise(link.end.x, link.end.y, sin, cos);
            let (turn_sin, turn_cos) = sin_cos(link.theta);
            (point + Vector2::new(x, y), S::rotate_clockwise(sin, cos, turn_sin, turn_cos))
        });
        SegmentShape { theta: link.map(|link| link.theta), end: before.map(|(point, _)| point) }
    })
}
