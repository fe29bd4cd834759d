//! The number that the whole pipeline is generic over, and the one that is the reference: `f64`.
//!
//! Three types are meant to implement [`Scalar`]: [`Q`](crate::Q), 32-bit fixed point, which the board runs; `f64`,
//! against which it is judged; and dual numbers over `f64`, whose derivatives tune the filters.

use core::fmt::Debug;
use core::ops::{Div, Neg};

use nalgebra::{ClosedAddAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};

use crate::angle::{Phase, Turns};
use crate::pcc::{AXIAL, COSINE};
use crate::q::Q;

/// A constant of the pipeline, held in both representations so that fixed-point code never touches a float.
#[derive(Debug, Clone, Copy)]
pub struct Constant {
    /// As a float.
    pub value: f64,
    /// As fixed point, rounded when the program is compiled.
    pub q: Q,
}

impl Constant {
    /// Both representations of `value`.
    #[must_use]
    pub const fn new(value: f64) -> Self {
        Self { value, q: Q::from_f64(value) }
    }
}

/// One whole turn, rad.
pub(crate) const TWO_PI: Constant = Constant::new(core::f64::consts::TAU);

/// A real number of the estimator: an angle in rad, a length in m, or a covariance as a ratio.
///
/// Arithmetic never panics. Angles that grow without bound (a drifting heading) and sums over the anchor's window are
/// not scalars but [`Turns`], exact integers; they carry no derivative, and need none, as no tuned parameter acts
/// before the filters.
///
/// ```
/// use estimator_core::{Q, Scalar};
///
/// fn third<S: Scalar>(x: S) -> S {
///     x / S::from_int(3)
/// }
/// assert_eq!(third(6.0), 2.0);
/// assert_eq!(third(Q::from_f64(6.0)), Q::from_f64(2.0));
/// ```
pub trait Scalar:
    Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + Div<Output = Self>
    + 'static
{
    /// The constant in this representation.
    fn constant(constant: Constant) -> Self;

    /// `value` in this representation, rounded to nearest. For tables and tests: the board never calls it.
    fn from_f64(value: f64) -> Self;

    /// The value as a float, without its derivatives. For reports and tests.
    fn to_f64(self) -> f64;

    /// A whole number.
    fn from_int(value: i32) -> Self;

    /// The exact fraction `value / 2^shift`, for `shift` ≤ 16.
    fn from_fraction(value: i32, shift: u32) -> Self;

    /// The nearest whole number.
    fn round(self) -> i32;

    /// A fraction of a turn as an angle in rad, −π…π.
    fn from_phase(phase: Phase) -> Self;

    /// An angle in rad as a count of turns.
    fn to_turns(self) -> Turns;

    /// `rest / (rest + 2π · turns)`, both angles in rad: the share that the remainder has in an unwrapped angle.
    ///
    /// `turns` is not 0, and `rest` is within ±π.
    #[must_use]
    fn share_of_unwrapped(rest: Self, turns: i32) -> Self {
        rest / (rest + Self::constant(TWO_PI) * Self::from_int(turns))
    }

    /// θ Σ aₖ (θ²/8)ᵏ and Σ bₖ (θ²/8)ᵏ at this angle θ, |θ| < 2 rad, where `odd` are 8 aₖ, `even` 8 bₖ, and each sum of the
    /// last terms is within ±4.
    ///
    /// The factor of 8 is for fixed point, which so keeps 29 fractional bits of them.
    #[must_use]
    fn polynomials<const K: usize>(self, odd: &[Self; K], even: &[Self; K]) -> (Self, Self) {
        let eighth = Self::constant(Constant::new(0.125));
        let x = self * self * eighth;
        let sum = |terms: &[Self; K]| terms.iter().rev().fold(Self::zero(), |sum, term| sum * x + *term) * eighth;
        (self * sum(odd), sum(even))
    }

    /// sin θ and cos θ of this angle θ, |θ| < 2 rad.
    #[must_use]
    fn sin_cos(self) -> (Self, Self) {
        self.polynomials(&AXIAL.map(Self::constant), &COSINE.map(Self::constant))
    }

    /// (x, y) turned clockwise by the angle of this sine and cosine: (x cos + y sin, y cos − x sin). It may be rounded down.
    #[must_use]
    fn turned(x: Self, y: Self, sin: Self, cos: Self) -> (Self, Self) {
        (Self::dot([x, y], [cos, sin]), Self::dot([y, x], [cos, -sin]))
    }

    /// Σ `a`ₖ `b`ₖ of up to three products, rounded once.
    #[must_use]
    fn dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        a.into_iter().zip(b).fold(Self::zero(), |sum, (a, b)| sum + a * b)
    }

    /// The product where it is known to be within ±16; it may be rounded down.
    #[must_use]
    fn bounded_product(self, other: Self) -> Self {
        self * other
    }

    /// Half of the value.
    #[must_use]
    fn half(self) -> Self {
        self * Self::constant(Constant::new(0.5))
    }

    /// c0 + c1 u + c2 u² at the fraction u = `value` / 2^`shift`, where u and c1 + c2 u are within ±32; `None` where it is beyond
    /// ±`limit`.
    #[must_use]
    fn quadratic(value: i32, shift: u32, [c0, c1, c2]: &[Self; 3], limit: Constant) -> Option<Self> {
        let u = Self::from_fraction(value, shift);
        let value = *c0 + u * (*c1 + u * *c2);
        value.is_within(Self::constant(limit)).then_some(value)
    }

    /// `self / (r + self · h)`, where none is negative and the divisor is within ±32, to a step of the representation.
    #[must_use]
    fn quotient(self, r: Self, h: Self) -> Self {
        self / (r + self * h)
    }

    /// `x` + `ratio` · (w0 a + w1 b + w2 x) of each `x` and its `a` and `b`.
    #[must_use]
    fn corrected<const D: usize>(x: [Self; D], ratio: Self, weights: &[Self; 3], [a, b]: [[Self; D]; 2]) -> [Self; D] {
        core::array::from_fn(|k| x[k] + ratio * Self::dot(*weights, [a[k], b[k], x[k]]))
    }

    /// Whether −`limit` ≤ `self` < `limit`, a positive one.
    #[must_use]
    fn is_within(self, limit: Self) -> bool {
        -limit <= self && self < limit
    }
}

impl Scalar for f64 {
    fn constant(constant: Constant) -> Self {
        constant.value
    }

    fn from_f64(value: f64) -> Self {
        value
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn from_int(value: i32) -> Self {
        Self::from(value)
    }

    fn from_fraction(value: i32, shift: u32) -> Self {
        Self::from(value) / Self::from(1_u32 << shift.min(16))
    }

    fn round(self) -> i32 {
        (self + if self < 0.0 { -0.5 } else { 0.5 }) as i32
    }

    fn from_phase(phase: Phase) -> Self {
        phase.rad()
    }

    fn to_turns(self) -> Turns {
        Turns::from_rad(self)
    }
}
