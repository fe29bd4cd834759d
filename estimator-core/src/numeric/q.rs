//! The board's number: 32-bit fixed point, the same bits on every machine.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::numeric::division::divide;
use crate::numeric::fused::FusedOps;
use crate::numeric::phase::{Phase, Turns};
use crate::numeric::saturation;
use crate::numeric::scalar::{Constant, Scalar};

/// Fixed point with 26 fractional bits: ±32 in steps of 1.5·10⁻⁸.
///
/// One format holds angles (rad), lengths (m) and covariances (ratios to the larger R). Operators round products and
/// quotients to nearest; some sums inside the pipeline are truncated. A result out of range saturates and is counted
/// ([`saturations`](crate::saturations)); so does a division by zero. There is no NaN. The Cortex-M3 has no float unit:
/// a product is one `smull` and a shift here, and 47 instructions in `f32`, which has 24 bits instead of 31.
///
/// ```
/// use estimator_core::Q;
///
/// let half = Q::from_f64(0.5);
/// assert_eq!((half * half).to_f64(), 0.25);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Q(pub(super) i32);

impl Q {
    /// Number of fractional bits.
    pub const FRACTION_BITS: u32 = 26;
    /// The largest value, just under 32.
    pub const MAX: Self = Self(i32::MAX);
    /// The smallest value, −32.
    pub const MIN: Self = Self(i32::MIN);

    /// From units of 2⁻²⁶.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// In units of 2⁻²⁶.
    #[must_use]
    pub const fn to_bits(self) -> i32 {
        self.0
    }

    /// `value` rounded to nearest; saturates without being counted, NaN becomes 0.
    #[must_use]
    pub const fn from_f64(value: f64) -> Self {
        let scaled = value * (1_u32 << Self::FRACTION_BITS) as f64;
        Self((if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i32)
    }

    /// The value as a float, exactly.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        f64::from(self.0) / f64::from(1_u32 << Self::FRACTION_BITS)
    }

    /// Saturates a result that was computed in 64 bits.
    #[inline]
    pub(super) fn fit(bits: i64) -> Self {
        i32::try_from(bits).map_or_else(|_| Self::overflowed(bits < 0), Self)
    }

    #[cold]
    fn divided_with_signs(self, other: Self) -> Self {
        let quotient = i64::from(divide::<{ Self::FRACTION_BITS }>(self.0.unsigned_abs(), other.0.unsigned_abs()));
        Self::fit(if (self.0 < 0) == (other.0 < 0) { quotient } else { -quotient })
    }

    #[cold]
    pub(super) fn overflowed(negative: bool) -> Self {
        saturation::count();
        if negative { Self::MIN } else { Self::MAX }
    }
}

impl Add for Q {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.0.checked_add(other.0).map_or_else(|| Self::overflowed(self.0 < 0), Self)
    }
}

impl Sub for Q {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.0.checked_sub(other.0).map_or_else(|| Self::overflowed(self.0 < 0), Self)
    }
}

impl Mul for Q {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::dot([self], [other])
    }
}

impl Div for Q {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        if (self.0 | other.0) < 0 {
            return self.divided_with_signs(other);
        }
        let quotient = divide::<{ Self::FRACTION_BITS }>(self.0 as u32, other.0 as u32) as i32;
        if quotient < 0 { Self::overflowed(false) } else { Self(quotient) }
    }
}

impl Neg for Q {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        self.0.checked_neg().map_or_else(|| Self::overflowed(false), Self)
    }
}

impl AddAssign for Q {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Q {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Q {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Zero for Q {
    #[inline]
    fn zero() -> Self {
        Self(0)
    }

    #[inline]
    fn is_zero(&self) -> bool {
        self.0 == 0
    }
}

impl One for Q {
    #[inline]
    fn one() -> Self {
        Self(1 << Self::FRACTION_BITS)
    }
}

impl Scalar for Q {
    #[inline]
    fn constant(constant: Constant) -> Self {
        constant.q
    }

    fn from_f64(value: f64) -> Self {
        Self::from_f64(value)
    }

    fn to_f64(self) -> f64 {
        self.to_f64()
    }

    #[inline]
    fn from_int(value: i32) -> Self {
        Self::fit(i64::from(value) << Self::FRACTION_BITS)
    }

    #[inline]
    fn from_fraction(value: i32, shift: u32) -> Self {
        let zeros = Self::FRACTION_BITS.wrapping_sub(shift);
        let bits = value.wrapping_shl(zeros);
        if bits.wrapping_shr(zeros) == value { Self(bits) } else { Self::overflowed(value < 0) }
    }

    #[inline]
    fn round(self) -> i32 {
        ((i64::from(self.0) + (1 << (Self::FRACTION_BITS - 1))) >> Self::FRACTION_BITS) as i32
    }

    #[inline]
    fn from_phase(phase: Phase) -> Self {
        const RAD: i64 = 1_686_629_713; // 2π/64 in units of 2⁻³⁴
        Self(((i64::from(phase.bits()) * RAD + (1 << 33)) >> 34) as i32)
    }

    #[inline]
    fn to_turns(self) -> Turns {
        const TURNS: i64 = 1_367_130_551; // 64/2π in units of 2⁻²⁷
        Turns::from_bits((i64::from(self.0) * TURNS + (1 << 26)) >> 27)
    }

    #[inline]
    fn half(self) -> Self {
        Self((self.0 >> 1) + (self.0 & 1))
    }

    #[inline]
    fn from_q(value: Q) -> Self {
        value
    }

    #[inline]
    fn to_q(self) -> Q {
        self
    }

    #[inline]
    fn from_micros(us: u32) -> Self {
        // 2⁻²⁶ of 64 s are 1.048576 µs: 2⁵⁰/10⁶ in units of 2⁻³⁰.
        const PER_MICRO: u64 = 1_125_899_907;
        Self(((u64::from(us) * PER_MICRO) >> 30).min(i32::MAX as u64) as i32)
    }

    #[inline]
    fn is_within(self, limit: Self) -> bool {
        self.0 ^ (self.0 >> 31) < limit.0
    }
}
