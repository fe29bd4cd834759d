//! Piecewise-constant-curvature kinematics (paper, eq. 4 to 7, with the corrections of `docs/explanation/paper.md`).

use nalgebra::Vector2;

use crate::config::{OffsetAt, SegmentConfig};
use crate::numeric::angle::Angle;
use crate::numeric::fused::FusedOps;
use crate::numeric::polynomial::{AXIAL, COSINE, Terms, VERSINE};
use crate::numeric::scalar::{Constant, TWO_PI};

/// Unit arc that turns by θ, smooth through θ = 0.
///
/// sin θ / θ and (1 − cos θ) / θ² are one minimax polynomial each in θ² for |θ| ≤ 2 rad (errors 1.4·10⁻¹² and
/// 2.2·10⁻¹¹); larger angles are reduced.
///
/// ```
/// use estimator_core::{Angle, UnitArc};
///
/// let quarter = UnitArc::new(Angle::from(core::f64::consts::FRAC_PI_2));
/// let radius = 2.0 / core::f64::consts::PI;
/// assert!((quarter.lateral - radius).abs() < 1e-9 && (quarter.axial - radius).abs() < 1e-9);
/// assert!((quarter.sin - 1.0).abs() < 1e-9 && quarter.cos.abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitArc<S> {
    /// (1 − cos θ) / θ: distance of the arc's end to the right of its start, per length.
    pub lateral: S,
    /// sin θ / θ: distance of the arc's end ahead of its start, per length.
    pub axial: S,
    /// cos θ.
    pub cos: S,
    /// sin θ.
    pub sin: S,
}

/// Largest |θ| for which the polynomials hold, rad: a step of [`Q`](crate::Q) under 2.
const LIMIT: Constant = Constant::new(2.0 - 1.0 / 67_108_864.0);

impl<S: FusedOps> UnitArc<S> {
    /// The unit arc that turns by `theta`, of any size.
    #[must_use]
    pub fn new(theta: Angle<S>) -> Self {
        if theta.whole_turns == 0 && theta.remainder.is_within(S::constant(LIMIT)) {
            Self::within_2_rad(theta.remainder)
        } else {
            Self::reduced(theta)
        }
    }

    #[cold]
    fn reduced(Angle { remainder, whole_turns }: Angle<S>) -> Self {
        const PI: Constant = Constant::new(core::f64::consts::PI);
        if whole_turns == 0 && remainder.is_within(S::constant(PI)) {
            return Self::within_half_turn(remainder);
        }
        // Whole turns do not change sine and cosine, and shrink the chord by the remainder over θ.
        let extra = (remainder / S::constant(TWO_PI)).round();
        let remainder = remainder - S::constant(TWO_PI) * S::from_int(extra);
        let arc = Self::within_half_turn(remainder);
        match whole_turns.saturating_add(extra) {
            0 => arc,
            whole_turns => {
                let share = S::share_of_unwrapped(remainder, whole_turns);
                Self { lateral: share * arc.lateral, axial: share * arc.axial, ..arc }
            }
        }
    }

    /// Double-angle formula: sin 2φ / 2φ = (sin φ / φ) cos φ and (1 − cos 2φ) / 2φ = (sin φ / φ) sin φ.
    fn within_half_turn(theta: S) -> Self {
        const HALF: Constant = Constant::new(0.5);
        let half = Self::within_2_rad(theta * S::constant(HALF));
        let (lateral, axial) = (half.axial * half.sin, half.axial * half.cos);
        Self { lateral, axial, cos: S::one() - theta * lateral, sin: theta * axial }
    }

    fn within_2_rad(theta: S) -> Self {
        let [versine, axial] = [VERSINE, AXIAL].map(|terms| terms.map(S::constant));
        let (lateral, axial) = theta.polynomials(&versine, &axial);
        let (sin, cos) = theta.sin_cos();
        Self { lateral, axial, cos, sin }
    }
}

/// One segment as a link of the chain: its bend angle and its end in its own frame {S_i}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentPose<S> {
    /// Bend angle θ_i.
    pub theta: Angle<S>,
    /// End of the segment, curved part and connector, P_i in {S_i}, m.
    pub end: Vector2<S>,
}

/// Kinematics of one segment, P_i = C_i + D_i with C_i = L ((1 − cos θ)/θ, sin θ/θ), and D_i along the tangent where
/// the connector is: d (sin θ, cos θ) at the end, d (0, 1) at the start.
///
/// Both coordinates are polynomials like those of [`UnitArc`], whose terms are computed once.
///
/// ```
/// use estimator_core::{Angle, Pcc, SegmentConfig};
///
/// let link = Pcc::<f64>::new(&SegmentConfig::uncalibrated(0.080, 0.017)).link(Angle::from(0.0));
/// assert!(link.end.x == 0.0 && (link.end.y - 0.097).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pcc<S> {
    /// L and d.
    lengths: [S; 2],
    offset_at: OffsetAt,
    /// Largest |θ| for which the polynomials hold, rad: 2, or 0 if their terms would be out of range.
    limit: S,
    /// x / θ.
    lateral: Terms<S>,
    /// y.
    axial: Terms<S>,
}

impl<S: FusedOps> Pcc<S> {
    /// Computes the terms from a segment's geometry.
    #[must_use]
    pub fn new(segment: &SegmentConfig<S>) -> Self {
        const LONGEST: Constant = Constant::new(0.7);
        let lengths = [segment.length, segment.offset];
        let fits = lengths.iter().all(|length| length.is_within(S::constant(LONGEST)));
        let zeros = [S::zero(); 7];
        if !fits {
            return Self { lengths, offset_at: segment.offset_at, limit: S::zero(), lateral: zeros, axial: zeros };
        }
        let [axial, versine, cos] = [AXIAL, VERSINE, COSINE].map(|terms| terms.map(S::constant));
        let one = core::array::from_fn(|k| if k == 0 { S::from_int(8) } else { S::zero() });
        let (sin, cos) = match segment.offset_at {
            OffsetAt::End => (axial, cos),
            OffsetAt::Start => (zeros, one),
        };
        let sum = |curve: Terms<S>, connector: Terms<S>| {
            let mut connector = connector.into_iter();
            curve.map(|curve| S::dot(lengths, [curve, connector.next().unwrap_or_else(S::zero)]))
        };
        let limit = S::constant(LIMIT);
        Self { lengths, offset_at: segment.offset_at, limit, lateral: sum(versine, sin), axial: sum(axial, cos) }
    }

    /// The segment bent by `theta`, of any size.
    #[inline]
    #[must_use]
    pub fn link(&self, theta: Angle<S>) -> SegmentPose<S> {
        let (x, y) = if theta.whole_turns == 0 && theta.remainder.is_within(self.limit) {
            theta.remainder.polynomials(&self.lateral, &self.axial)
        } else {
            self.by_arc(theta)
        };
        SegmentPose { theta, end: Vector2::new(x, y) }
    }

    #[cold]
    fn by_arc(&self, theta: Angle<S>) -> (S, S) {
        let arc = UnitArc::new(theta);
        let (sin, cos) = match self.offset_at {
            OffsetAt::End => (arc.sin, arc.cos),
            OffsetAt::Start => (S::zero(), S::one()),
        };
        (S::dot(self.lengths, [arc.lateral, sin]), S::dot(self.lengths, [arc.axial, cos]))
    }
}

/// sin θ and cos θ.
#[inline]
pub(crate) fn sin_cos<S: FusedOps>(theta: Angle<S>) -> (S, S) {
    if theta.whole_turns == 0 && theta.remainder.is_within(S::constant(LIMIT)) {
        theta.remainder.sin_cos()
    } else {
        let arc = UnitArc::new(theta);
        (arc.sin, arc.cos)
    }
}
