//! The number type that the pipeline is generic over, and the reference implementation: `f64`.
//!
//! Three types implement [`Scalar`]: [`Q`](crate::Q), 32-bit fixed point, which the board runs; `f64`, the reference;
//! and dual numbers over `f64`, whose derivatives tune the filters. [`FusedOps`](crate::FusedOps) has the operations
//! with a faster form in fixed point.

use core::fmt::Debug;
use core::ops::{Div, Neg};

use nalgebra::{ClosedAddAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};

use crate::numeric::phase::{Phase, Turns};
use crate::numeric::q::Q;

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

/// Unit of time of the drift filter, s: a power of two, and of the order in which drift changes.
pub const TIME_UNIT_S: f64 = 64.0;

/// One whole turn, rad.
pub(crate) const TWO_PI: Constant = Constant::new(core::f64::consts::TAU);

/// A real number of the estimator: an angle in rad, a length in m, or a covariance as a ratio.
///
/// Arithmetic never panics. Angles that grow without bound (a drifting heading) and sums over the anchor's window are
/// not scalars but [`Turns`], exact integers. These need no derivative, as no tuned parameter acts before the filters.
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

    /// A fixed-point number, exactly.
    fn from_q(value: Q) -> Self;

    /// The value in fixed point, rounded to nearest.
    fn to_q(self) -> Q;

    /// A time of `us` microseconds in units of [`TIME_UNIT_S`].
    fn from_micros(us: u32) -> Self;

    /// Half of the value.
    #[must_use]
    fn half(self) -> Self {
        self * Self::constant(Constant::new(0.5))
    }

    /// Returns `true` if −`limit` ≤ `self` < `limit`, for a positive limit.
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

    fn from_q(value: Q) -> Self {
        value.to_f64()
    }

    fn to_q(self) -> Q {
        Q::from_f64(self)
    }

    fn from_micros(us: u32) -> Self {
        Self::from(us) * (1e-6 / TIME_UNIT_S)
    }
}
