//! Angles and variances of the drift filter: constants in degrees, and squares that are held
//! [`VARIANCE_SCALE`](crate::VARIANCE_SCALE) times as large.

use crate::config::VARIANCE_SCALE;
use crate::numeric::scalar::{Constant, Scalar};

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// The square root of the scale.
const ROOT_SCALE: i32 = 8;
/// The square of an angle from here on, 40°, is as good as infinite, and does not fit.
const LARGEST_ANGLE: Constant = Constant::new(0.7);
const LARGEST: Constant = Constant::new(31.0);

/// An angle in degrees, held in rad.
pub const fn degrees(degrees: f64) -> Constant {
    Constant::new(degrees * DEGREE)
}

/// The variance of a standard deviation in degrees, held in rad² and scaled.
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

/// The square of an angle (rad) as variances are held; from 40° on as large as they get.
pub fn scaled_square<S: Scalar>(x: S) -> S {
    let root = magnitude(x);
    if root >= S::constant(LARGEST_ANGLE) {
        return S::constant(LARGEST);
    }
    let root = root * S::from_int(ROOT_SCALE);
    root * root
}

/// Whether an angle is beyond so many standard deviations, given as one over their number.
pub fn is_beyond<S: Scalar>(x: S, inverse_deviations: Constant, variance: S) -> bool {
    scaled_square(x * S::constant(inverse_deviations)) > variance
}
