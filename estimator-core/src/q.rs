//! The board's number: 32-bit fixed point, the same bits on every machine.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use crate::angle::{Phase, Turns};
use crate::fixed::{divide, nearly_divide};
use crate::overflow;
use crate::pcc::{AXIAL, COSINE, Terms};
use crate::scalar::{Constant, Scalar, TWO_PI};

/// Fixed point with 26 fractional bits: ±32 in steps of 1.5·10⁻⁸.
///
/// One format holds angles (rad), lengths (m) and covariances (ratios to the larger R). Products and quotients by operators
/// are rounded to nearest, while some sums inside the pipeline are cut off; what does not fit saturates and is counted
/// ([`saturations`](crate::saturations)), and a division by zero is
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

    /// Half of the last bit that remains of a sum of products.
    const HALF: i64 = 1 << (Self::FRACTION_BITS - 1);

    /// `start` + Σ aₖ bₖ, wrapped.
    #[inline]
    fn sum<const K: usize>(start: i64, (a, b): &([Self; K], [Self; K])) -> i64 {
        a.iter().zip(b).fold(start, |sum, (a, b)| sum.wrapping_add(i64::from(a.0) * i64::from(b.0)))
    }

    /// What is under [`Self::ROOM`] where a sum fits, also of several in one. Three products are below 2⁶⁴ − 2⁶² in size, so
    /// that no sum fits only because it has wrapped.
    #[inline]
    fn excess(sum: i64) -> u32 {
        ((sum >> 32) as u32).wrapping_add(Self::ROOM / 2)
    }

    const ROOM: u32 = 1 << Self::FRACTION_BITS;

    /// The value as a sum of products is held, in units of 2⁻⁵².
    #[inline]
    fn wide(self) -> i64 {
        // Word by word, which the compiler does not see by itself.
        let upper = self.0 >> (32 - Self::FRACTION_BITS);
        (i64::from(upper) << 32) | i64::from((self.0 << Self::FRACTION_BITS) as u32)
    }

    /// The value of a sum that fits.
    #[inline]
    fn narrow(sum: i64) -> Self {
        Self((sum >> Self::FRACTION_BITS) as i32)
    }

    /// Whether all sums fit: one check, so that they are worked out in one go.
    #[inline]
    fn all_fit(sums: &[i64]) -> bool {
        sums.iter().fold(0, |all, sum| all | Self::excess(*sum)) < Self::ROOM
    }

    /// [`Scalar::dot`] of what is beyond the range. Out of line and by value, so that nothing is kept for it before.
    #[cold]
    #[inline(never)]
    fn saturated_dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        const { assert!(K <= 3) };
        let quarters = a.iter().zip(b).map(|(a, b)| (i64::from(a.0) * i64::from(b.0)) >> 2);
        Self::overflowed(quarters.sum::<i64>() < 0)
    }

    /// [`Scalar::turned`] where one of the two may be beyond the range.
    #[cold]
    #[inline(never)]
    fn saturated_turned(x: Self, y: Self, sin: Self, cos: Self) -> (Self, Self) {
        (Self::dot([x, y], [cos, sin]), Self::dot([y, x], [cos, -sin]))
    }

    /// [`Scalar::corrected`] where a sum may be beyond the range.
    #[cold]
    #[inline(never)]
    fn saturated_corrected(self, ratio: Self, weights: &[Self; 3], a: Self, b: Self) -> Self {
        self + ratio * Self::dot(*weights, [a, b, self])
    }

    /// Out of line, for what hardly happens.
    #[cold]
    #[inline(never)]
    fn divided(self, other: Self) -> Self {
        self / other
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

    /// Σ cₖ xᵏ in units of 2⁻²⁹, from terms 8 cₖ and x in units of 2⁻³².
    #[inline]
    fn horner<const K: usize>(x: i32, terms: &[Self; K]) -> i32 {
        // The lower word of a product is left in the sum, where it rounds as well as a half would: a term is one `smlal`.
        let sum = terms.iter().rev().fold(1 << 31, |sum: i64, term| {
            ((i64::from(term.0) << 32) | (sum & 0xFFFF_FFFF)).wrapping_add((sum >> 32) * i64::from(x))
        });
        (sum >> 32) as i32
    }
}

/// A polynomial's terms as fixed point, in the flash of a board.
const fn fixed(terms: Terms<Constant>) -> Terms<Q> {
    let mut fixed = [Q(0); 7];
    let mut k = 0;
    while k < terms.len() {
        fixed[k] = terms[k].q;
        k += 1;
    }
    fixed
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

    // Out of line, as the compiler spoils a sum of constants whose signs it sees.
    #[inline(never)]
    fn polynomials<const K: usize>(self, odd: &[Self; K], even: &[Self; K]) -> (Self, Self) {
        // θ²/8 in units of 2⁻³².
        let x = ((i64::from(self.0) * i64::from(self.0)) >> 23) as i32;
        let (odd, even) = (Self::horner(x, odd), Self::horner(x, even));
        (Self(((i64::from(self.0) * i64::from(odd) + (1 << 28)) >> 29) as i32), Self(even.wrapping_add(4) >> 3))
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        const SIN: Terms<Q> = fixed(AXIAL);
        const COS: Terms<Q> = fixed(COSINE);
        self.polynomials(&SIN, &COS)
    }

    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    fn turned(x: Self, y: Self, sin: Self, cos: Self) -> (Self, Self) {
        let minus_sin = Self(sin.0.wrapping_neg());
        let (across, along) = (Self::sum(0, &([x, y], [cos, sin])), Self::sum(0, &([y, x], [cos, minus_sin])));
        if Self::all_fit(&[across, along]) {
            (Self::narrow(across), Self::narrow(along))
        } else {
            Self::saturated_turned(x, y, sin, cos)
        }
    }

    #[inline]
    fn dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        let sum = Self::sum(Self::HALF, &(a, b));
        if Self::all_fit(&[sum]) { Self::narrow(sum) } else { Self::saturated_dot(a, b) }
    }

    #[inline]
    fn bounded_product(self, other: Self) -> Self {
        Self::narrow(Self::sum(0, &([self], [other])))
    }

    #[inline]
    fn half(self) -> Self {
        Self((self.0 >> 1) + (self.0 & 1))
    }

    #[inline]
    fn quadratic(value: i32, shift: u32, [c0, c1, c2]: &[Self; 3], limit: Constant) -> Option<Self> {
        let u = Self(value.wrapping_shl(Self::FRACTION_BITS.wrapping_sub(shift)));
        let slope = c1.0.wrapping_add(Self::narrow(i64::from(c2.0) * i64::from(u.0)).0);
        let sum = Self::sum(c0.wide() + Self::HALF, &([u], [Self(slope)]));
        // By the upper word, which is enough.
        let (upper, limit) = ((sum >> 32) as i32, limit.q.0 >> (32 - Self::FRACTION_BITS));
        (upper ^ (upper >> 31) < limit).then_some(Self::narrow(sum))
    }

    // It is called twice a segment; out of line, saving registers is a fifth of it.
    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    fn quotient(self, r: Self, h: Self) -> Self {
        let den = Self::narrow(r.wide() + i64::from(self.0) * i64::from(h.0));
        nearly_divide::<{ Self::FRACTION_BITS }>(self.0 as u32, den.0 as u32)
            .map_or_else(|| self.divided(den), |bits| Self(bits as i32))
    }

    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    fn corrected<const D: usize>(x: [Self; D], ratio: Self, weights: &[Self; 3], [a, b]: [[Self; D]; 2]) -> [Self; D] {
        let (mut innovations, mut sums) = ([0; D], [0; D]);
        for k in 0..D {
            innovations[k] = Self::sum(0, &(*weights, [a[k], b[k], x[k]]));
            sums[k] = Self::sum(x[k].wide() + Self::HALF, &([ratio], [Self::narrow(innovations[k])]));
        }
        let fit = Self::all_fit(&innovations) & Self::all_fit(&sums);
        let mut values = [Self(0); D];
        for k in 0..D {
            values[k] = if fit { Self::narrow(sums[k]) } else { x[k].saturated_corrected(ratio, weights, a[k], b[k]) };
        }
        values
    }

    #[inline]
    fn is_within(self, limit: Self) -> bool {
        self.0 ^ (self.0 >> 31) < limit.0
    }

    #[inline]
    fn share_of_unwrapped(rest: Self, turns: i32) -> Self {
        let total = i64::from(rest.0) + i64::from(TWO_PI.q.0) * i64::from(turns);
        let excess = 33_u32.saturating_sub(total.unsigned_abs().leading_zeros());
        Self(rest.0 >> excess) / Self((total >> excess) as i32)
    }
}
