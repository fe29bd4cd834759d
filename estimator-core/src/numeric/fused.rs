//! Operations that fixed point evaluates faster fused than as a sequence of operators.
//!
//! [`FusedOps`] has one method per operation, whose default is the plain form in [`plain`]. [`Q`](crate::Q) overrides
//! them in [`q_fused`](super::q_fused); property tests compare both forms.

use crate::numeric::polynomial::{AXIAL, COSINE};
use crate::numeric::scalar::{Constant, Scalar, TWO_PI};

/// The plain forms, in operators of [`Scalar`].
pub mod plain {
    use super::{Constant, Scalar, TWO_PI};

    /// `remainder / (remainder + 2π · whole_turns)`.
    pub fn share_of_unwrapped<S: Scalar>(remainder: S, whole_turns: i32) -> S {
        remainder / (remainder + S::constant(TWO_PI) * S::from_int(whole_turns))
    }

    /// θ Σ aₖ (θ²/8)ᵏ and Σ bₖ (θ²/8)ᵏ of `odd` = 8 aₖ and `even` = 8 bₖ.
    pub fn polynomials<S: Scalar, const K: usize>(theta: S, odd: &[S; K], even: &[S; K]) -> (S, S) {
        let eighth = S::constant(Constant::new(0.125));
        let x = theta * theta * eighth;
        let sum = |terms: &[S; K]| terms.iter().rev().fold(S::zero(), |sum, term| sum * x + *term) * eighth;
        (theta * sum(odd), sum(even))
    }

    /// (x cos + y sin, y cos − x sin).
    pub fn rotate_clockwise<S: Scalar>(x: S, y: S, sin: S, cos: S) -> (S, S) {
        (x * cos + y * sin, y * cos - x * sin)
    }

    /// Σ `a`ₖ `b`ₖ.
    pub fn dot<S: Scalar, const K: usize>(a: [S; K], b: [S; K]) -> S {
        a.into_iter().zip(b).fold(S::zero(), |sum, (a, b)| sum + a * b)
    }

    /// c0 + c1 u + c2 u² at u = `value` / 2^`shift`.
    pub fn eval_quadratic<S: Scalar>(value: i32, shift: u32, [c0, c1, c2]: &[S; 3]) -> S {
        let u = S::from_fraction(value, shift);
        *c0 + u * (*c1 + u * *c2)
    }

    /// p / (r + p h).
    pub fn gain_over_innovation_variance<S: Scalar>(p: S, r: S, h: S) -> S {
        p / (r + p * h)
    }

    /// Each of `values` less its product.
    pub fn subtract_products<S: Scalar>(values: &mut [S], others: &[S], factor: S) {
        for (value, other) in values.iter_mut().zip(others) {
            *value -= *other * factor;
        }
    }

    /// Each of `values` over the divisor.
    pub fn divide_all<S: Scalar>(values: &mut [S], divisor: S) {
        for value in values {
            *value = *value / divisor;
        }
    }

    /// x + ratio (w0 a + w1 b + w2 x).
    pub fn kalman_update<S: Scalar>(x: S, ratio: S, [w0, w1, w2]: &[S; 3], a: S, b: S) -> S {
        x + ratio * (*w0 * a + *w1 * b + *w2 * x)
    }
}

/// Operations with a faster form in fixed point.
pub trait FusedOps: Scalar {
    /// `remainder / (remainder + 2π · whole_turns)`, both angles in rad: the share that the remainder has in an unwrapped angle.
    ///
    /// `whole_turns` is not 0, and `remainder` is within ±π.
    #[must_use]
    fn share_of_unwrapped(remainder: Self, whole_turns: i32) -> Self {
        plain::share_of_unwrapped(remainder, whole_turns)
    }

    /// θ Σ aₖ (θ²/8)ᵏ and Σ bₖ (θ²/8)ᵏ at this angle θ, |θ| < 2 rad, where `odd` are 8 aₖ, `even` 8 bₖ, and each sum of
    /// the last terms is within ±4.
    ///
    /// The factor of 8 is for fixed point, which so keeps 29 fractional bits of them.
    #[must_use]
    fn polynomials<const K: usize>(self, odd: &[Self; K], even: &[Self; K]) -> (Self, Self) {
        plain::polynomials(self, odd, even)
    }

    /// sin θ and cos θ of this angle θ, |θ| < 2 rad.
    #[must_use]
    fn sin_cos(self) -> (Self, Self) {
        self.polynomials(&AXIAL.map(Self::constant), &COSINE.map(Self::constant))
    }

    /// (x, y) rotated clockwise by the angle of this sine and cosine: (x cos + y sin, y cos − x sin). It may be rounded
    /// down.
    #[must_use]
    fn rotate_clockwise(x: Self, y: Self, sin: Self, cos: Self) -> (Self, Self) {
        plain::rotate_clockwise(x, y, sin, cos)
    }

    /// Σ `a`ₖ `b`ₖ of up to three products, rounded once.
    #[must_use]
    fn dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        plain::dot(a, b)
    }

    /// The product, which must be within ±16; it may be rounded down.
    #[must_use]
    fn mul_unchecked_range(self, other: Self) -> Self {
        self * other
    }

    /// c0 + c1 u + c2 u² at the fraction u = `value` / 2^`shift`, where u and c1 + c2 u are within ±32; `None` where it
    /// is beyond ±`limit`.
    #[must_use]
    fn eval_quadratic(value: i32, shift: u32, coefficients: &[Self; 3], limit: Constant) -> Option<Self> {
        let value = plain::eval_quadratic(value, shift, coefficients);
        value.is_within(Self::constant(limit)).then_some(value)
    }

    /// `self / (r + self · h)`, where none is negative and the divisor is within ±32, to a step of the representation.
    #[must_use]
    fn gain_over_innovation_variance(self, r: Self, h: Self) -> Self {
        plain::gain_over_innovation_variance(self, r, h)
    }

    /// Subtracts from each of `values` the product of its place in `others` and of `factor`: to the bit as the
    /// operators do where the product is within ±32.
    fn subtract_products(values: &mut [Self], others: &[Self], factor: Self) {
        plain::subtract_products(values, others, factor);
    }

    /// Divides all `values`, to the bit as the operator does.
    fn divide_all(values: &mut [Self], divisor: Self) {
        plain::divide_all(values, divisor);
    }

    /// `x` + `ratio` · (w0 a + w1 b + w2 x) of each `x` and its `a` and `b`.
    #[must_use]
    fn kalman_update<const D: usize>(
        x: [Self; D],
        ratio: Self,
        weights: &[Self; 3],
        [a, b]: [[Self; D]; 2],
    ) -> [Self; D] {
        core::array::from_fn(|k| plain::kalman_update(x[k], ratio, weights, a[k], b[k]))
    }
}

impl FusedOps for f64 {}
