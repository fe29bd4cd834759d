//! Covariance of the shape: errors of the headings, propagated along the chain to the world points.
//!
//! An error of a heading turns the arc before it and the arc after it. A share λ of a segment's chord turns with the
//! segment's own heading and the remainder with the heading before: λ = ½ for an arc, 1 for a connector after it. The
//! Jacobian of point m with respect to heading j is the chord, turned by 90° and multiplied by its lever; C_m = Σ J_j
//! P_jk J_kᵀ.

use nalgebra::Vector2;

use crate::config::{OffsetAt, SegmentConfig};
use crate::numeric::fused::FusedOps;
use crate::numeric::q::Q;
use crate::numeric::scalar::Scalar;
use crate::types::Covariance;

/// Share of a segment's chord that turns with its own heading, λ.
pub fn lever_arm<S: Scalar>(segment: &SegmentConfig<S>) -> Q {
    let own = match segment.offset_at {
        OffsetAt::End => segment.length.half() + segment.offset,
        OffsetAt::Start => segment.length.half(),
    };
    (own / (segment.length + segment.offset)).to_q()
}

/// Covariance of the newest point of a chain with all headings, segment by segment from the base.
///
/// ```
/// use estimator_core::{CovariancePropagation, Q, VARIANCE_SCALE};
/// use nalgebra::Vector2;
///
/// // A straight arm of one arc of 0.1 m, whose heading has σ = 0.1 rad: its end has σ = 5 mm, sideways.
/// let (zero, headings) = (Q::from_f64(0.0), [Q::from_f64(0.01 * VARIANCE_SCALE)]);
/// let mut propagation = CovariancePropagation::new();
/// propagation.step(&headings, Vector2::new(zero, Q::from_f64(0.1)), Q::from_f64(0.5), zero);
/// let [xx, xy, yy] = propagation.end().square_metres();
/// assert!((xx.sqrt() - 0.005).abs() < 1e-5 && xy.abs() < 1e-9 && yy < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct CovariancePropagation<const N: usize> {
    /// Covariance of the heading before with all headings.
    before: [Q; N],
    /// Covariance of the newest point and each heading.
    cross: [Vector2<Q>; N],
    point: Covariance,
    segment: usize,
}

impl<const N: usize> CovariancePropagation<N> {
    /// The base, which is fixed.
    #[must_use]
    pub const fn new() -> Self {
        let zero = Q::from_bits(0);
        let point = Covariance { xx: zero, xy: zero, yy: zero };
        Self { before: [zero; N], cross: [Vector2::new(zero, zero); N], point, segment: 0 }
    }

    /// Propagates over one segment with its `chord` from start to end in {W} and its [lever arm](lever_arm) λ; returns
    /// the variance of its bend angle θ_i = Θ_i − Θ_{i−1}.
    ///
    /// Variances are [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times rad² of its heading with all `headings`, and m² of
    /// its `end`, which it adds to either coordinate.
    pub fn step(&mut self, headings: &[Q; N], chord: Vector2<Q>, lever: Q, end: Q) -> Q {
        let Self { before, cross, point, segment } = self;
        let zero = Q::from_bits(0);
        let complement = Q::from_f64(1.0) - lever;
        // Derivative of the chord with respect to its angle, clockwise positive: (x, y) to (y, −x).
        let turn = Vector2::new(chord.y, -chord.x);
        let (k, k_before) = (Some(*segment), segment.checked_sub(1));
        let at = |row: &[Q; N], k: Option<usize>| k.and_then(|k| row.get(k)).copied().unwrap_or(zero);
        let [own, shared, of_before] = [at(headings, k), at(headings, k_before), at(before, k_before)];
        let theta = (own - shared) + (of_before - shared);
        let cross_at = |k: Option<usize>| k.and_then(|k| cross.get(k)).copied().unwrap_or(Vector2::new(zero, zero));
        let (of_own, of_below) = (cross_at(k), cross_at(k_before));
        // Covariance of the chord's angle (weighted by λ) with the heading, and with the one before.
        let with_own = lever.mul_unchecked_range(own) + complement.mul_unchecked_range(at(before, k));
        let with_before = lever.mul_unchecked_range(shared) + complement.mul_unchecked_range(of_before);
        let half = Q::dot([lever, complement], [with_own, with_before]).half();
        // Covariance of the angle with the point, and half of its variance along the turn.
        let side = Vector2::new(
            Q::dot([lever, complement, half], [of_own.x, of_below.x, turn.x]),
            Q::dot([lever, complement, half], [of_own.y, of_below.y, turn.y]),
        );
        point.xx += Q::dot([turn.x; 2], [side.x; 2]) + end;
        point.xy += Q::dot([turn.x, turn.y], [side.y, side.x]);
        point.yy += Q::dot([turn.y; 2], [side.y; 2]) + end;
        for (cross, (own, before)) in cross.iter_mut().zip(headings.iter().zip(before.iter_mut())) {
            let angle = lever.mul_unchecked_range(*own) + complement.mul_unchecked_range(*before);
            *cross += Vector2::new(turn.x.mul_unchecked_range(angle), turn.y.mul_unchecked_range(angle));
            *before = *own;
        }
        *segment += 1;
        theta
    }

    /// Covariance of the newest segment's end.
    #[must_use]
    pub fn end(&self) -> Covariance {
        self.point
    }
}

impl<const N: usize> Default for CovariancePropagation<N> {
    fn default() -> Self {
        Self::new()
    }
}
