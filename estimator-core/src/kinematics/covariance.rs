//! Covariance of the shape: errors of the headings, propagated along the chain to the world points.
//!
//! An error of a heading turns the arc that ends with it and the arc that begins with it. Of the end's chord, a share λ turns
//! with the segment's own heading and the rest with the heading before: λ = ½ for an arc, 1 for a connector behind it. The
//! Jacobian of point m by heading j is the chord, turned by a quarter and levered; C_m = Σ J_j P_jk J_kᵀ.

use heapless::Vec;
use nalgebra::Vector2;

use crate::config::{OffsetAt, SegmentConfig};
use crate::numeric::fused::FusedOps;
use crate::numeric::q::Q;
use crate::numeric::scalar::Scalar;
use crate::types::{Covariance, Shape, Uncertainties, Uncertainty};

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
/// // A straight arm of one arc of 0.1 m whose heading may be off by 0.1 rad: its end may be off by 5 mm, sideways.
/// let heading = [[Q::from_f64(0.01 * VARIANCE_SCALE)]];
/// let mut propagation = CovariancePropagation::new(heading, Q::from_f64(0.0));
/// propagation.step(Vector2::new(Q::from_f64(0.0), Q::from_f64(0.1)), Q::from_f64(0.5));
/// let [xx, xy, yy] = propagation.end().square_metres();
/// assert!((xx.sqrt() - 0.005).abs() < 1e-5 && xy.abs() < 1e-9 && yy < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct CovariancePropagation<const N: usize> {
    /// P of the headings.
    headings: [[Q; N]; N],
    /// Covariance of the newest point and each heading.
    cross: [Vector2<Q>; N],
    point: Covariance,
    /// Variance that each segment adds to either coordinate of its end.
    end: Q,
    segment: usize,
}

impl<const N: usize> CovariancePropagation<N> {
    /// The base, which is fixed. Variances are [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times rad² of the `headings` and m²
    /// of each `end`.
    #[must_use]
    pub fn new(headings: [[Q; N]; N], end: Q) -> Self {
        let zero = Q::from_f64(0.0);
        let point = Covariance { xx: zero, xy: zero, yy: zero };
        Self { headings, cross: [Vector2::new(zero, zero); N], point, end, segment: 0 }
    }

    /// Propagates over one segment with its `chord` from start to end in {W} and its [lever arm](lever_arm) λ.
    pub fn step(&mut self, chord: Vector2<Q>, lever: Q) {
        let Self { headings, cross, point, end, segment } = self;
        let zero = Q::from_f64(0.0);
        let Some(own) = headings.get(*segment) else { return };
        let before = segment.checked_sub(1).and_then(|before| headings.get(before));
        let rest = Q::from_f64(1.0) - lever;
        // Derivative of the chord by its angle, clockwise positive: (x, y) to (y, −x).
        let turn = Vector2::new(chord.y, -chord.x);
        // Covariance of the chord's levered angle with each heading.
        let angle = |k: usize| {
            let before = before.and_then(|row| row.get(k)).copied().unwrap_or(zero);
            lever.mul_unchecked_range(own.get(k).copied().unwrap_or(zero)) + rest.mul_unchecked_range(before)
        };
        let at = |k: Option<usize>| k.and_then(|k| cross.get(k)).copied().unwrap_or_else(|| Vector2::new(zero, zero));
        let (k, k_before) = (*segment, segment.checked_sub(1));
        let (of_own, of_before) = (at(Some(k)), at(k_before));
        let variance = lever * angle(k) + k_before.map_or(zero, |before| rest * angle(before));
        let half = variance.half();
        // Covariance of the angle with the point, and half of its variance along the turn.
        let side = Vector2::new(
            Q::dot([lever, rest, half], [of_own.x, of_before.x, turn.x]),
            Q::dot([lever, rest, half], [of_own.y, of_before.y, turn.y]),
        );
        point.xx += Q::dot([turn.x; 2], [side.x; 2]) + *end;
        point.xy += Q::dot([turn.x, turn.y], [side.y, side.x]);
        point.yy += Q::dot([turn.y; 2], [side.y; 2]) + *end;
        // Later segments need no heading before this one.
        for (k, cross) in cross.iter_mut().enumerate().skip(k) {
            let angle = angle(k);
            *cross += Vector2::new(turn.x.mul_unchecked_range(angle), turn.y.mul_unchecked_range(angle));
        }
        *segment += 1;
    }

    /// Covariance of the newest segment's end.
    #[must_use]
    pub fn end(&self) -> Covariance {
        self.point
    }
}

/// Uncertainty of a shape by the covariance of its `headings` and the variance of each segment's `end`, segment by segment;
/// the bend angles that nothing has measured have none.
#[must_use]
pub fn shape_uncertainties<S: Scalar, const N: usize>(
    segments: &[SegmentConfig<S>],
    end: Q,
    headings: [[Q; N]; N],
    shape: &Shape<S, N>,
    is_measured: impl Fn(usize) -> bool,
) -> Uncertainties<N> {
    let mut propagation = CovariancePropagation::new(headings, end);
    let zero = Q::from_f64(0.0);
    let (mut before, mut is_known) = (Vector2::new(zero, zero), true);
    let mut uncertainties = Vec::new();
    for (i, (shape, config)) in shape.iter().zip(segments).enumerate() {
        let theta = shape.theta.map(|_| theta_variance(&propagation.headings, i)).filter(|_| is_measured(i));
        let end = theta.zip(shape.end).filter(|_| is_known).map(|(_, end)| {
            let end = Vector2::new(end.x.to_q(), end.y.to_q());
            propagation.step(end - before, lever_arm(config));
            before = end;
            propagation.end()
        });
        is_known = end.is_some();
        let _ = uncertainties.push(Uncertainty { theta, end });
    }
    uncertainties
}

/// Variance of θ_i = Θ_i − Θ_{i−1}.
fn theta_variance<const N: usize>(headings: &[[Q; N]; N], i: usize) -> Q {
    let at = |i: usize, j: usize| headings.get(i).and_then(|row| row.get(j)).copied().unwrap_or(Q::from_f64(0.0));
    match i.checked_sub(1) {
        Some(below) => (at(i, i) - at(i, below)) + (at(below, below) - at(i, below)),
        None => at(i, i),
    }
}
