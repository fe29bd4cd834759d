//! Dual numbers, which carry a derivative through the estimator.

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use estimator_core::{Constant, FusedOps, Phase, Q, Scalar, Turns};
use num_dual::Dual64;
use num_traits::{One, Zero};

/// A float and its derivative by one parameter, through every operation of the estimator.
///
/// ```
/// use proprio_calibration::tune::Dual;
///
/// let r = Dual::new(0.5, 1.0);
/// let gain = r / (r + r * r);
/// // d/dr 1/(1 + r)
/// assert_eq!(gain.derivative(), -1.0 / (1.5 * 1.5));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Dual(Dual64);

impl Dual {
    /// A value and its derivative.
    #[must_use]
    pub fn new(value: f64, derivative: f64) -> Self {
        Self(Dual64::new(value, derivative))
    }

    /// The derivative.
    #[must_use]
    pub fn derivative(self) -> f64 {
        self.0.eps
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident $assign:ident $assign_method:ident),*) => {$(
        impl $operator for Dual {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
        impl $assign for Dual {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                self.0.$assign_method(other.0);
            }
        }
    )*};
}
operators!(Add add AddAssign add_assign, Sub sub SubAssign sub_assign, Mul mul MulAssign mul_assign);

impl Div for Dual {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for Dual {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Compares values alone: the estimator takes the same branches as with floats.
impl PartialEq for Dual {
    fn eq(&self, other: &Self) -> bool {
        self.0.re == other.0.re
    }
}

impl PartialOrd for Dual {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.re.partial_cmp(&other.0.re)
    }
}

impl Zero for Dual {
    fn zero() -> Self {
        Self(Dual64::zero())
    }

    fn is_zero(&self) -> bool {
        self.0.re == 0.0
    }
}

impl One for Dual {
    fn one() -> Self {
        Self(Dual64::one())
    }
}

impl Scalar for Dual {
    fn constant(constant: Constant) -> Self {
        Self::from_f64(constant.value)
    }

    fn from_f64(value: f64) -> Self {
        Self(Dual64::from_re(value))
    }

    fn to_f64(self) -> f64 {
        self.0.re
    }

    fn from_int(value: i32) -> Self {
        Self::from_f64(f64::from(value))
    }

    fn from_fraction(value: i32, shift: u32) -> Self {
        Self::from_f64(f64::from_fraction(value, shift))
    }

    fn round(self) -> i32 {
        Scalar::round(self.0.re)
    }

    fn from_phase(phase: Phase) -> Self {
        Self::from_f64(phase.rad())
    }

    fn to_turns(self) -> Turns {
        Turns::from_rad(self.0.re)
    }

    fn from_q(value: Q) -> Self {
        Self::from_f64(value.to_f64())
    }

    fn to_q(self) -> Q {
        Q::from_f64(self.0.re)
    }

    fn from_micros(us: u32) -> Self {
        Self::from_f64(f64::from_micros(us))
    }
}

impl FusedOps for Dual {}
