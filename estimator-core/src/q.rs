//! The board's number: 32-bit fixed point, the same bits on every machine.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::angle::{Phase, Turns};
use crate::fixed::{divide, signed_upper_word};
use crate::overflow;
use crate::scalar::{Constant, Scalar, TWO_PI};

/// Fixed point with 26 fractional bits: ±32 in steps of 1.5·10⁻⁸.
///
/// One format holds angles (rad), lengths (m) and covariances (ratios to the larger R). Products and quotients are rounded to
/// nearest; what does not fit saturates and is counted ([`saturations`](crate::saturations)), and a division by zero is
/// such an overflow. There is no NaN. The Cortex-M3 has no float unit: a product is one `smull` and a shift here, and
/// 47 instructions in `f32`, which carries 24 bits instead of 31.
///
/// ```
/// use estimator_core::Q;
///
/// let half = Q::from_f64(0.5);
/// assert_eq!((half * half).to_f64(), 0.25);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Q(i32);

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
    fn fit(bits: i64) -> Self {
        i32::try_from(bits).map_or_else(|_| Self::overflowed(bits < 0), Self)
    }

    /// Σ aₖ bₖ, which has wrapped only where it is out of range still: three products are below 2⁶⁴ − 2⁶² in size.
    #[inline]
    fn sum<const K: usize>((a, b): &([Self; K], [Self; K])) -> i64 {
        const { assert!(K <= 3) };
        a.iter().zip(b).fold(0, |sum: i64, (a, b)| sum.wrapping_add(i64::from(a.0) * i64::from(b.0)))
    }

    /// The value of a sum of products that is within ±16, rounded to nearest.
    #[inline]
    fn nearest(sum: i64) -> Self {
        Self(((sum + (1 << (Self::FRACTION_BITS - 1))) >> Self::FRACTION_BITS) as i32)
    }

    /// The value of any sum of products.
    #[inline]
    fn saturated<const K: usize>((a, b): ([Self; K], [Self; K])) -> Self {
        let rounded = Self::sum(&(a, b)).saturating_add(1 << (Self::FRACTION_BITS - 1)) >> Self::FRACTION_BITS;
        let quarters = || a.iter().zip(b).map(|(a, b)| (i64::from(a.0) * i64::from(b.0)) >> 2);
        i32::try_from(rounded).map_or_else(|_| Self::overflowed(quarters().sum::<i64>() < 0), Self)
    }

    #[cold]
    fn divided_with_signs(self, other: Self) -> Self {
        let quotient = i64::from(divide::<{ Self::FRACTION_BITS }>(self.0.unsigned_abs(), other.0.unsigned_abs()));
        Self::fit(if (self.0 < 0) == (other.0 < 0) { quotient } else { -quotient })
    }

    #[cold]
    fn overflowed(negative: bool) -> Self {
        overflow::count();
        if negative { Self::MIN } else { Self::MAX }
    }

    /// Σ cₖ (θ²/4)ᵏ in units of 2⁻²⁹, from terms 8 cₖ.
    #[inline]
    fn horner<const K: usize>(self, terms: &[Self; K]) -> i32 {
        // θ²/4 in units of 2⁻³¹: what is wanted of a product is its upper word, doubled.
        let x = ((i64::from(self.0) * i64::from(self.0)) >> 23) as i32;
        terms.iter().rev().fold(0, |sum, term| term.0.wrapping_add(signed_upper_word(sum, x) << 1))
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
    fn even_polynomial<const K: usize>(self, terms: &[Self; K]) -> Self {
        Self(self.horner(terms).wrapping_add(4) >> 3)
    }

    #[inline]
    fn odd_polynomial<const K: usize>(self, terms: &[Self; K]) -> Self {
        Self(((i64::from(self.0) * i64::from(self.horner(terms)) + (1 << 28)) >> 29) as i32)
    }

    #[inline]
    fn dots<const M: usize, const K: usize>(pairs: [([Self; K], [Self; K]); M]) -> [Self; M] {
        let sums = pairs.each_ref().map(Self::sum);
        // The upper word without its sign; all sums in one check, so that they are worked out in one go.
        let magnitudes = sums.iter().map(|sum| ((sum >> 32) ^ (sum >> 63)) as u32);
        if magnitudes.fold(0, |all, magnitude| all | magnitude) >> 24 != 0 {
            return pairs.map(Self::saturated);
        }
        sums.map(Self::nearest)
    }

    #[inline]
    fn is_within(self, limit: Self) -> bool {
        -limit.0 < self.0 && self.0 < limit.0
    }

    #[inline]
    fn share_of_unwrapped(rest: Self, turns: i32) -> Self {
        let total = i64::from(rest.0) + i64::from(TWO_PI.q.0) * i64::from(turns);
        let excess = 33_u32.saturating_sub(total.unsigned_abs().leading_zeros());
        Self(rest.0 >> excess) / Self((total >> excess) as i32)
    }
}
