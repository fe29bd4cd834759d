//! Piecewise-constant-curvature kinematics (paper, eq. 4 to 7, with the corrections of `docs/PAPER.md`).

use nalgebra::Vector2;

use crate::angle::Angle;
use crate::scalar::{Constant, Scalar, TWO_PI};
use crate::table::{OffsetAt, Segment};

/// A unit arc that turns by θ: what PCC needs of an angle, smooth through θ = 0.
///
/// sin θ / θ and (1 − cos θ) / θ² are one minimax polynomial each in θ² for |θ| ≤ 2 rad (errors 1.4·10⁻¹² and
/// 2.2·10⁻¹¹); larger angles are reduced.
///
/// ```
/// use estimator_core::{Angle, Arc};
///
/// let quarter = Arc::new(Angle::from(core::f64::consts::FRAC_PI_2));
/// let radius = 2.0 / core::f64::consts::PI;
/// assert!((quarter.lateral - radius).abs() < 1e-9 && (quarter.axial - radius).abs() < 1e-9);
/// assert!((quarter.sin - 1.0).abs() < 1e-9 && quarter.cos.abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc<S> {
    /// (1 − cos θ) / θ: how far the arc's end lies to the right of its start, per length.
    pub lateral: S,
    /// sin θ / θ: how far the arc's end lies ahead of its start, per length.
    pub axial: S,
    /// cos θ.
    pub cos: S,
    /// sin θ.
    pub sin: S,
}

/// Up to this |θ| the polynomials hold, rad: a step of [`Q`](crate::Q) under 2.
const LIMIT: Constant = Constant::new(2.0 - 1.0 / 67_108_864.0);

/// Terms of a polynomial in θ²/8, eightfold as [`Scalar::polynomials`] takes them.
pub(crate) type Terms<T> = [T; 7];

/// sin θ / θ.
pub(crate) const AXIAL: Terms<Constant> = eightfold([
    0.999_999_999_998_558,
    -0.666_666_666_525_055_1,
    0.133_333_331_062_445_16,
    -0.012_698_399_036_356_584,
    7.054_281_954_497_206e-4,
    -2.559_557_300_796_330_8e-5,
    6.152_922_495_571_073e-7,
]);

/// (1 − cos θ) / θ².
const VERSINE: Terms<Constant> = eightfold([
    0.499_999_999_978_359_6,
    -0.166_666_665_104_189_15,
    0.022_222_203_937_815_63,
    -0.001_587_223_271_061_236,
    7.039_481_349_596_013e-5,
    -2.001_239_275_599_844e-6,
    0.0,
]);

/// cos θ = 1 − θ² (1 − cos θ) / θ².
pub(crate) const COSINE: Terms<Constant> = {
    let mut terms = [Constant::new(8.0); 7];
    let mut k = 1;
    while k < terms.len() {
        terms[k] = Constant::new(-8.0 * VERSINE[k - 1].value);
        k += 1;
    }
    terms
};

/// From the terms in θ²/4.
const fn eightfold(terms: Terms<f64>) -> Terms<Constant> {
    let mut constants = [Constant::new(0.0); 7];
    let mut k = 0;
    while k < terms.len() {
        constants[k] = Constant::new((8_u32 << k) as f64 * terms[k]);
        k += 1;
    }
    constants
}

impl<S: Scalar> Arc<S> {
    /// The unit arc that turns by `theta`, of any size.
    #[must_use]
    pub fn new(theta: Angle<S>) -> Self {
        if theta.turns == 0 && theta.rest.is_within(S::constant(LIMIT)) {
            Self::within_2_rad(theta.rest)
        } else {
            Self::reduced(theta)
        }
    }

    #[cold]
    fn reduced(Angle { rest, turns }: Angle<S>) -> Self {
        const PI: Constant = Constant::new(core::f64::consts::PI);
        if turns == 0 && rest.is_within(S::constant(PI)) {
            return Self::within_half_turn(rest);
        }
        // Whole turns leave sine and cosine alone and shrink the chord by r/θ.
        let extra = (rest / S::constant(TWO_PI)).round();
        let rest = rest - S::constant(TWO_PI) * S::from_int(extra);
        let arc = Self::within_half_turn(rest);
        match turns.saturating_add(extra) {
            0 => arc,
            turns => {
                let share = S::share_of_unwrapped(rest, turns);
                Self { lateral: share * arc.lateral, axial: share * arc.axial, ..arc }
            }
        }
    }

    /// By the double angle: sin 2φ / 2φ = (sin φ / φ) cos φ and (1 − cos 2φ) / 2φ = (sin φ / φ) sin φ.
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

/// One segment as a link of the chain: its bend angle and where its end lies in its own frame {S_i}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link<S> {
    /// Bend angle θ_i.
    pub theta: Angle<S>,
    /// End of the segment, curved part and connector, P_i in {S_i}, m.
    pub end: Vector2<S>,
}

/// Kinematics of one segment, P_i = C_i + D_i with C_i = L ((1 − cos θ)/θ, sin θ/θ), and D_i along the tangent where the
/// connector is: d (sin θ, cos θ) at the end, d (0, 1) at the start.
///
/// Both coordinates are polynomials like those of [`Arc`], whose terms are worked out once.
///
/// ```
/// use estimator_core::{Angle, Pcc, Segment};
///
/// let link = Pcc::<f64>::new(&Segment::bare(0.080, 0.017)).link(Angle::from(0.0));
/// assert!(link.end.x == 0.0 && (link.end.y - 0.097).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pcc<S> {
    /// L and d.
    lengths: [S; 2],
    offset_at: OffsetAt,
    /// Up to this |θ| the polynomials hold, rad: 2, or 0 where their terms would be out of range.
    limit: S,
    /// x / θ.
    lateral: Terms<S>,
    /// y.
    axial: Terms<S>,
}

impl<S: Scalar> Pcc<S> {
    /// From a segment's geometry.
    #[must_use]
    pub fn new(segment: &Segment<S>) -> Self {
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
    pub fn link(&self, theta: Angle<S>) -> Link<S> {
        let (x, y) = if theta.turns == 0 && theta.rest.is_within(self.limit) {
            theta.rest.polynomials(&self.lateral, &self.axial)
        } else {
            self.by_arc(theta)
        };
        Link { theta, end: Vector2::new(x, y) }
    }

    #[cold]
    fn by_arc(&self, theta: Angle<S>) -> (S, S) {
        let arc = Arc::new(theta);
        let (sin, cos) = match self.offset_at {
            OffsetAt::End => (arc.sin, arc.cos),
            OffsetAt::Start => (S::zero(), S::one()),
        };
        (S::dot(self.lengths, [arc.lateral, sin]), S::dot(self.lengths, [arc.axial, cos]))
    }
}

/// One segment of the arm's shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentShape<S> {
    /// Bend angle θ_i.
    pub theta: Option<Angle<S>>,
    /// End of the segment in {W}, m.
    pub end: Option<Vector2<S>>,
}

/// Chains links from the base on: P_W,i = P_W,i−1 + R(Θ_i−1) P_i, where R(α) maps (x, y) to
/// (x cos α + y sin α, −x sin α + y cos α). From the first unknown link on, every end is unknown.
///
/// ```
/// use estimator_core::{chain, Angle, Pcc, Segment};
///
/// let segments = [Segment::bare(0.080, 0.017), Segment::bare(0.080, 0.017)];
/// let straight = segments.iter().map(|segment| Some(Pcc::<f64>::new(segment).link(Angle::from(0.0))));
/// let tip = chain(straight).last().and_then(|segment| segment.end).expect("all links are known");
/// assert!(tip.x == 0.0 && (tip.y - 0.194).abs() < 1e-12);
/// ```
#[inline]
pub fn chain<S: Scalar>(links: impl Iterator<Item = Option<Link<S>>>) -> impl Iterator<Item = SegmentShape<S>> {
    // Products of cosines and sines instead of the sum of the angles: no trigonometry, and nothing to wrap.
    let mut before = Some((Vector2::zeros(), (S::zero(), S::one())));
    links.map(move |link| {
        before = before.zip(link).map(|((point, (sin, cos)), link)| {
            let (x, y) = S::turned(link.end.x, link.end.y, sin, cos);
            let (turn_sin, turn_cos) = sin_cos(link.theta);
            (point + Vector2::new(x, y), S::turned(sin, cos, turn_sin, turn_cos))
        });
        SegmentShape { theta: link.map(|link| link.theta), end: before.map(|(point, _)| point) }
    })
}

/// sin θ and cos θ.
#[inline]
pub(crate) fn sin_cos<S: Scalar>(theta: Angle<S>) -> (S, S) {
    if theta.turns == 0 && theta.rest.is_within(S::constant(LIMIT)) {
        theta.rest.sin_cos()
    } else {
        let arc = Arc::new(theta);
        (arc.sin, arc.cos)
    }
}
