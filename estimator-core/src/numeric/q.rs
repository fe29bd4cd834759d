//! The board's number: 32-bit fixed point, the same bits on every machine.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::numeric::division::divide;
use crate::numeric::saturation;

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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Q(pub(super) i32);

impl Q {
    /// Number of fractional bits.
    pub const FRACTION_BITS: u32 = 26;
    /// The largest value, just under 32.
    pub const MAX: Self = Self(i32::MAX);
    /// The smallest value, −32.
    pub const MIN: Self = Self(i32::MIN);

    /// Converts from units of 2⁻²⁶.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// Returns the value in units of 2⁻²⁶.
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

/// Sums of products in 64 bits, in units of 2⁻⁵²: checked and rounded once.
impl Q {
    /// Bound of the overflow indicator of a sum that fits.
    pub(super) const ROOM: u32 = 1 << Self::FRACTION_BITS;

    /// Half of the last bit of a result, in units of a sum of products: rounds to nearest.
    pub(super) const HALF: i64 = 1 << (Self::FRACTION_BITS - 1);

    /// Overflow indicator of a sum, below [`Self::ROOM`] if it fits; indicators of several sums can be combined by `|`.
    /// Three products are below 2⁶⁴ − 2⁶² in size, so that a wrapped sum never seems to fit.
    #[inline]
    fn excess(sum: i64) -> u32 {
        ((sum >> 32) as u32).wrapping_add(Self::ROOM / 2)
    }

    /// The value in the format of a sum of products, in units of 2⁻⁵².
    #[inline]
    pub(super) fn wide(self) -> i64 {
        // Word by word: the compiler does not find this form of the shift.
        let upper = self.0 >> (32 - Self::FRACTION_BITS);
        (i64::from(upper) << 32) | i64::from((self.0 << Self::FRACTION_BITS) as u32)
    }

    /// Converts a sum of products that fits.
    #[inline]
    pub(super) fn narrow(sum: i64) -> Self {
        Self((sum >> Self::FRACTION_BITS) as i32)
    }

    /// Returns `true` if all sums fit: one check instead of one per sum.
    #[inline]
    pub(super) fn all_fit(sums: &[i64]) -> bool {
        sums.iter().fold(0, |all, sum| all | Self::excess(*sum)) < Self::ROOM
    }

    /// [`Self::rounded_dot`] out of range. Not inlined and by value, so that the fast path reserves no registers for
    /// it.
    #[cold]
    #[inline(never)]
    fn saturated_dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        const { assert!(K <= 3) };
        let quarters = a.iter().zip(b).map(|(a, b)| (i64::from(a.0) * i64::from(b.0)) >> 2);
        Self::overflowed(quarters.sum::<i64>() < 0)
    }

    /// `start` + Σ aₖ bₖ, wrapped.
    #[inline]
    pub(super) fn sum<const K: usize>(start: i64, (a, b): &([Self; K], [Self; K])) -> i64 {
        a.iter().zip(b).fold(start, |sum, (a, b)| sum.wrapping_add(i64::from(a.0) * i64::from(b.0)))
    }

    /// Σ aₖ bₖ of up to three products, rounded once to nearest.
    #[inline]
    pub(super) fn rounded_dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        let sum = Self::sum(Self::HALF, &(a, b));
        if Self::all_fit(&[sum]) { Self::narrow(sum) } else { Self::saturated_dot(a, b) }
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
        Self::rounded_dot([self], [other])
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
