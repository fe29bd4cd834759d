//! How far the shape may be off: variances of the bend angles, propagated along the chain to the world points.
//!
//! Variances are held [`SCALE`] times as large as they are, in rad², rad m and m², so that fixed point has 34 fractional
//! bits for them: a deviation of 0.01° is 8 steps of its variance, and 5 rad or 5 m are as many as there can be.

use nalgebra::Vector2;

use crate::scalar::Scalar;

/// What variances are multiplied by.
pub const SCALE: f64 = 256.0;

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
    /// Where the point is known exactly.
    #[must_use]
    pub fn zero() -> Self {
        Self { xx: S::zero(), xy: S::zero(), yy: S::zero() }
    }

    /// As a matrix xx, xy, yy in m². For reports.
    #[must_use]
    pub fn square_metres(self) -> [f64; 3] {
        [self.xx, self.xy, self.yy].map(|value| value.to_f64() / SCALE)
    }
}

/// Covariance of the newest heading and point of a chain, segment by segment from the base.
///
/// An error of the heading before a segment turns it about its start; one of its own bend angle turns its end about a point
/// on the way, a `lever` of its chord from the end: half of an arc's, all of a connector's behind it. The errors of the
/// bend angles are taken to be independent.
///
/// ```
/// use estimator_core::Spread;
/// use nalgebra::Vector2;
///
/// // A straight arm of one arc of 0.1 m whose bend angle may be off by 0.1 rad: its end may be off by 5 mm, sideways.
/// let mut spread = Spread::<f64>::base();
/// let end = spread.step(Vector2::new(0.0, 0.1), 0.5, 0.01 * estimator_core::SCALE, 0.0);
/// let [xx, xy, yy] = end.square_metres();
/// assert!((xx.sqrt() - 0.005).abs() < 1e-12 && xy.abs() < 1e-12 && yy < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread<S> {
    heading: S,
    /// Covariance of heading and point.
    cross: Vector2<S>,
    point: Covariance<S>,
}

impl<S: Scalar> Spread<S> {
    /// The base, which is where it is.
    #[must_use]
    pub fn base() -> Self {
        Self { heading: S::zero(), cross: Vector2::zeros(), point: Covariance::zero() }
    }

    /// Goes on by one segment: its `chord` from start to end in {W}, its `lever`, the variance of its bend angle, and that
    /// of what its end is off in either direction whatever the angle ([`SCALE`] times m²). Gives its end's covariance.
    pub fn step(&mut self, chord: Vector2<S>, lever: S, theta: S, point: S) -> Covariance<S> {
        // How the end moves with the heading, clockwise positive: (x, y) to (y, −x).
        let (gx, gy) = (chord.y, -chord.x);
        let levered = lever * theta;
        let weight = self.heading + lever * levered;
        let (tx, ty) = (weight * gx, weight * gy);
        let (cx, cy) = (self.cross.x, self.cross.y);
        self.point.xx += gx * (cx + cx + tx) + point;
        self.point.xy += gx * (cy + ty) + gy * cx;
        self.point.yy += gy * (cy + cy + ty) + point;
        let shared = self.heading + levered;
        self.cross = Vector2::new(cx + shared * gx, cy + shared * gy);
        self.heading += theta;
        self.point
    }
}
