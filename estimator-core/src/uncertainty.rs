//! How far the shape may be off: variances of the bend angles, propagated along the chain to the world points.
//!
//! Variances are held [`SCALE`] times as large as they are, in rad², rad m and m², so that fixed point has 32 fractional
//! bits for them: 1 mm² is 4300 steps, and 0.5 rad² or m² are as many as there can be.

use heapless::Vec;
use nalgebra::Vector2;

use crate::angle::Phase;
use crate::beyond::Seen;
use crate::scalar::{Constant, Scalar};
use crate::table::{OffsetAt, Segment};

/// What variances are multiplied by.
pub const SCALE: f64 = 64.0;

/// Nothing is said of an angle whose variance is beyond this, 9.5°: the sum along the longest arm would leave fixed point.
const LARGEST: Constant = Constant::new(1.75);

/// What the angles' and ends' variances are made of, each [`SCALE`] times as large; the same for all segments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UncertaintyRule<S> {
    /// Of θ whatever is known of the drift, rad².
    pub theta: S,
    /// Factor on the observer's variance of the bias, which is a share of the measurement's and taken for one of a turn, rad.
    pub drift: S,
    /// Of θ where bend sensors alone tell it, rad².
    pub bend: S,
    /// Of θ while something touches the segment, beside the others, rad².
    pub contact: S,
    /// Of each heading by itself, rad²: what one θ has too much of it, the next has too little.
    pub heading: S,
    /// Of either coordinate of a segment's end in its own frame, whatever the angle, m².
    pub end: S,
}

/// What is known of one segment's error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty<S> {
    /// Variance of θ_i, [`SCALE`] times rad²; `None` where nothing was measured.
    pub theta: Option<S>,
    /// Covariance of the segment's end in {W}; `None` from the first unknown angle on.
    pub end: Option<Covariance<S>>,
}

/// The errors of the fused shape, from the base to the tip.
pub type Uncertainties<S, const N: usize> = Vec<Uncertainty<S>, N>;

/// What the variance of one segment's bend angle comes from.
pub(crate) struct Sources {
    pub seen: Seen,
    /// The observer's variance of the bias, as a share of the measurement's in units of 2⁻³⁰.
    pub drift: i32,
    pub is_touched: bool,
}

impl<S: Scalar> UncertaintyRule<S> {
    /// Variance of θ but for the headings' own errors; `None` where nothing was measured.
    pub(crate) fn theta(&self, sources: &Sources) -> Option<S> {
        let measured = match sources.seen {
            Seen { imu: true, .. } => {
                // One, of which it is less than half, is a whole turn.
                self.theta + self.drift * S::from_phase(Phase::from_bits(sources.drift << 2))
            }
            Seen { imu: false, bend: true } => self.bend,
            Seen { imu: false, bend: false } => return None,
        };
        let theta = if sources.is_touched { measured + self.contact } else { measured };
        theta.is_within(S::constant(LARGEST)).then_some(theta)
    }
}

/// Covariance of a world point, [`SCALE`] times m².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Covariance<S> {
    /// Variance of x.
    pub xx: S,
    /// Covariance of x and y.
    pub xy: S,
    /// Variance of y.
    pub yy: S,
}

impl<S: Scalar> Covariance<S> {
    /// xx, xy and yy in m². For reports.
    #[must_use]
    pub fn square_metres(self) -> [f64; 3] {
        [self.xx, self.xy, self.yy].map(|value| value.to_f64() / SCALE)
    }
}

/// How far from a segment's end the point lies that the end turns about as θ changes, as a share of its chord: half of
/// an arc's, and all of a connector's behind it.
pub(crate) fn lever<S: Scalar>(segment: &Segment<S>) -> S {
    let arm = match segment.offset_at {
        OffsetAt::End => segment.length.half() + segment.offset,
        OffsetAt::Start => segment.length.half(),
    };
    arm / (segment.length + segment.offset)
}

/// Covariance of the newest heading and point of a chain, segment by segment from the base.
///
/// An error of the heading before a segment turns it about its start; one of its own bend angle turns its end about a point
/// on the way, a `lever` of its chord from the end: half of an arc's, all of a connector's behind it. These errors of the
/// bend angles are taken to be independent, and add up along the chain. Beside them each heading has an error of its own, its
/// gyroscope's, which turns one chord and goes no further.
///
/// ```
/// use estimator_core::{SCALE, Spread};
/// use nalgebra::Vector2;
///
/// // A straight arm of one arc of 0.1 m whose bend angle may be off by 0.1 rad: its end may be off by 5 mm, sideways.
/// let mut spread = Spread::<f64>::base(0.0, 0.0);
/// spread.step(Vector2::new(0.0, 0.1), 0.5, 0.01 * SCALE);
/// let [xx, xy, yy] = spread.end().square_metres();
/// assert!((xx.sqrt() - 0.005).abs() < 1e-12 && xy.abs() < 1e-12 && yy < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread<S> {
    /// Variance of each heading's own error, and of each end's in either direction.
    own: [S; 2],
    heading: S,
    /// Covariance of heading and point.
    cross: Vector2<S>,
    point: Covariance<S>,
}

impl<S: Scalar> Spread<S> {
    /// The base, which is where it is. The variances are those of each `heading`'s own error, and of what each `end` is off in
    /// either direction whatever the angles.
    #[must_use]
    pub fn base(heading: S, end: S) -> Self {
        let point = Covariance { xx: S::zero(), xy: S::zero(), yy: S::zero() };
        Self { own: [heading, end], heading: S::zero(), cross: Vector2::zeros(), point }
    }

    /// Goes on by one segment: its `chord` from start to end in {W}, its `lever`, and the variance of its bend angle that adds
    /// up.
    #[inline(never)]
    pub fn step(&mut self, chord: Vector2<S>, lever: S, theta: S) {
        let [heading, end] = self.own;
        // How the end moves with the heading, clockwise positive: (x, y) to (y, −x).
        let turn = Vector2::new(chord.y, -chord.x);
        let levered = lever.bounded_product(theta);
        // What the end's covariance grows by is the product of this and `turn`, and its transpose.
        let half = (self.heading + lever.bounded_product(levered) + heading).half();
        let side = Vector2::new(self.cross.x + half * turn.x, self.cross.y + half * turn.y);
        self.point.xx += S::dot([turn.x; 2], [side.x; 2]) + end;
        self.point.xy += S::dot([turn.x, turn.y], [side.y, side.x]);
        self.point.yy += S::dot([turn.y; 2], [side.y; 2]) + end;
        let shared = self.heading + levered;
        self.cross += Vector2::new(shared * turn.x, shared * turn.y);
        self.heading += theta;
    }

    /// Covariance of the newest segment's end.
    #[must_use]
    pub fn end(&self) -> Covariance<S> {
        self.point
    }
}
