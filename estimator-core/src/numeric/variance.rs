//! Angles and variances of the bias filter: constants in degrees, and squares that are multiplied by
//! [`VARIANCE_SCALE`](crate::VARIANCE_SCALE).

use crate::numeric::scalar::{Constant, Scalar};

/// Factor of all variances in fixed point: one step is 2⁻³² rad² or m², the largest value 0.5.
pub const VARIANCE_SCALE: f64 = 64.0;

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// The square root of the scale.
const ROOT_SCALE: i32 = 8;
/// Limit of an angle whose square fits, rad (40°); the square of a larger one is replaced by [`LARGEST`].
const LARGEST_ANGLE: Constant = Constant::new(0.7);
const LARGEST: Constant = Constant::new(31.0);

/// An angle, converted from degrees to rad.
pub const fn degrees(degrees: f64) -> Constant {
    Constant::new(degrees * DEGREE)
}

/// The variance of a standard deviation, converted from degrees to scaled rad².
pub const fn variance_deg(deviation: f64) -> Constant {
    Constant::new(deviation * DEGREE * deviation * DEGREE * VARIANCE_SCALE)
}

/// |x|.
pub fn magnitude<S: Scalar>(x: S) -> S {
    if x < S::zero() { -x } else { x }
}

/// The smaller one.
pub fn smaller<S: Scalar>(a: S, b: S) -> S {
    if a < b { a } else { b }
}

/// The larger one.
pub fn larger<S: Scalar>(a: S, b: S) -> S {
    if a < b { b } else { a }
}

/// The square of an angle (rad) as a scaled variance; from 40° on the largest value.
pub fn scaled_square<S: Scalar>(x: S) -> S {
    let root = magnitude(x);
    if root >= S::constant(LARGEST_ANGLE) {
        return S::constant(LARGEST);
    }
    let root = root * S::from_int(ROOT_SCALE);
    root * root
}

/// Returns `true` if an angle is over k standard deviations, for `inverse_deviations` = 1/k.
pub fn is_beyond<S: Scalar>(x: S, inverse_deviations: Constant, variance: S) -> bool {
    scaled_square(x * S::constant(inverse_deviations)) > variance
}
