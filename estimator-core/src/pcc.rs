//! Piecewise-constant-curvature kinematics (paper, eq. 4 to 7, with the corrections of `docs/PAPER.md`).

use nalgebra::Vector2;

use crate::angle::Angle;
use crate::scalar::{Constant, Scalar, TWO_PI};
use crate::table::{OffsetAt, Segment};

/// A unit arc that turns by θ: what PCC needs of an angle, smooth through θ = 0.
///
/// sin θ / θ and (1 − cos θ) / θ² are one minimax polynomial each in θ²/4 for |θ| ≤ 2 rad (errors 1.4·10⁻¹² and
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

const SIN_OVER_ANGLE: [Constant; 7] = Constant::array([
    0.999_999_999_998_558,
    -0.666_666_666_525_055_1,
    0.133_333_331_062_445_16,
    -0.012_698_399_036_356_584,
    7.054_281_954_497_206e-4,
    -2.559_557_300_796_330_8e-5,
    6.152_922_495_571_073e-7,
]);

const VERSINE_OVER_SQUARE: [Constant; 6] = Constant::array([
    0.499_999_999_978_359_6,
    -0.166_666_665_104_189_15,
    0.022_222_203_937_815_63,
    -0.001_587_223_271_061_236,
    7.039_481_349_596_013e-5,
    -2.001_239_275_599_844e-6,
]);

fn polynomial<S: Scalar, const K: usize>(terms: &[Constant; K], x: S) -> S {
    terms.iter().rev().fold(S::zero(), |sum, term| sum * x + S::constant(*term))
}

impl<S: Scalar> Arc<S> {
    /// The unit arc that turns by `theta`, of any size.
    #[must_use]
    pub fn new(theta: Angle<S>) -> Self {
        const PI: Constant = Constant::new(core::f64::consts::PI);
        let Angle { rest, turns } = theta;
        if turns == 0 && rest.magnitude() <= S::constant(PI) {
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

    fn within_half_turn(theta: S) -> Self {
        const HALF: Constant = Constant::new(0.5);
        const LIMIT: Constant = Constant::new(2.0);
        if theta.magnitude() <= S::constant(LIMIT) {
            return Self::within_2_rad(theta);
        }
        // sin 2φ / 2φ = (sin φ / φ) cos φ and (1 − cos 2φ) / 2φ = (sin φ / φ) sin φ.
        let half = Self::within_2_rad(theta * S::constant(HALF));
        let (lateral, axial) = (half.axial * half.sin, half.axial * half.cos);
        Self { lateral, axial, cos: S::one() - theta * lateral, sin: theta * axial }
    }

    fn within_2_rad(theta: S) -> Self {
        const HALF: Constant = Constant::new(0.5);
        let half = theta * S::constant(HALF);
        let square = half * half;
        let axial = polynomial(&SIN_OVER_ANGLE, square);
        let lateral = theta * polynomial(&VERSINE_OVER_SQUARE, square);
        Self { lateral, axial, cos: S::one() - theta * lateral, sin: theta * axial }
    }
}

/// One segment as a link of the chain: its bend angle and where its end lies in its own frame {S_i}.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link<S> {
    /// Bend angle θ_i.
    pub theta: Angle<S>,
    /// End of the segment, curved part and connector, P_i in {S_i}, m.
    pub end: Vector2<S>,
    /// cos θ_i and sin θ_i, which turn {S_i} into {S_i+1}.
    pub direction: Vector2<S>,
}

impl<S: Scalar> Link<S> {
    /// The link of a segment bent by `theta`: P_i = C_i + D_i with C_i = L ((1 − cos θ)/θ, sin θ/θ), and D_i along the
    /// tangent where the connector is: d (sin θ, cos θ) at the end, d (0, 1) at the start.
    #[must_use]
    pub fn new(theta: Angle<S>, segment: &Segment<S>) -> Self {
        let arc = Arc::new(theta);
        let curve = Vector2::new(segment.length * arc.lateral, segment.length * arc.axial);
        let connector = match segment.offset_at {
            OffsetAt::End => Vector2::new(segment.offset * arc.sin, segment.offset * arc.cos),
            OffsetAt::Start => Vector2::new(S::zero(), segment.offset),
        };
        Self { theta, end: curve + connector, direction: Vector2::new(arc.cos, arc.sin) }
    }
}

/// Chains links from the base on: P_W,i = P_W,i−1 + R(Θ_i−1) P_i, where R(α) maps (x, y) to
/// (x cos α + y sin α, −x sin α + y cos α). From the first unknown link on, every end is unknown.
///
/// ```
/// use estimator_core::{chain, Angle, Link, Segment};
///
/// let segments = [Segment::bare(0.080, 0.017), Segment::bare(0.080, 0.017)];
/// let straight = segments.iter().map(|segment| Some(Link::<f64>::new(Angle::from(0.0), segment)));
/// let tip = chain(straight).last().flatten().expect("all links are known");
/// assert!(tip.x == 0.0 && (tip.y - 0.194).abs() < 1e-12);
/// ```
pub fn chain<S: Scalar>(links: impl Iterator<Item = Option<Link<S>>>) -> impl Iterator<Item = Option<Vector2<S>>> {
    // Products of cosines and sines instead of the sum of the angles: no trigonometry, and nothing to wrap.
    let base = Some((Vector2::zeros(), Vector2::new(S::one(), S::zero())));
    links.scan(base, |before, link| {
        *before = before.zip(link).map(|((point, heading), link)| {
            let (cos, sin) = (heading.x, heading.y);
            let step = Vector2::new(link.end.x * cos + link.end.y * sin, link.end.y * cos - link.end.x * sin);
            let (c, s) = (link.direction.x, link.direction.y);
            (point + step, Vector2::new(cos * c - sin * s, sin * c + cos * s))
        });
        Some(before.map(|(point, _)| point))
    })
}
