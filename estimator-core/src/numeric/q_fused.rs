//! Fast forms of [`FusedOps`] for [`Q`], tuned to the Cortex-M3.
//!
//! All products of a sum are added in 64 bits (`smlal`) and checked once, where operators check and round each product.
//! The whole step took 4,974 instructions with them and 44,000 in `f32`. A property test compares each form with its
//! plain form in [`plain`](super::fused::plain).

use crate::numeric::division::{Divisor, div_approx};
use crate::numeric::fused::{FusedOps, plain};
use crate::numeric::polynomial::{AXIAL, COSINE, Terms};
use crate::numeric::q::Q;
use crate::numeric::scalar::{Constant, TWO_PI};

impl Q {
    /// [`FusedOps::rotate_clockwise`] where one of the two may be beyond the range.
    #[cold]
    #[inline(never)]
    fn saturated_rotation(x: Self, y: Self, sin: Self, cos: Self) -> (Self, Self) {
        (Self::dot([x, y], [cos, sin]), Self::dot([y, x], [cos, -sin]))
    }

    /// [`FusedOps::kalman_update`] where a sum may be beyond the range.
    #[cold]
    #[inline(never)]
    fn saturated_update(self, ratio: Self, weights: &[Self; 3], a: Self, b: Self) -> Self {
        self + ratio * Self::dot(*weights, [a, b, self])
    }

    /// [`FusedOps::subtract_products`] where the product or the difference is beyond the range.
    #[cold]
    #[inline(never)]
    fn saturated_difference(self, other: Self, factor: Self) -> Self {
        self - other * factor
    }

    /// Division, not inlined: it is rare.
    #[cold]
    #[inline(never)]
    fn divided(self, other: Self) -> Self {
        self / other
    }

    /// Σ cₖ xᵏ in units of 2⁻²⁹, from terms 8 cₖ and x in units of 2⁻³².
    #[inline]
    fn horner<const K: usize>(x: i32, terms: &[Self; K]) -> i32 {
        // The lower word of a product stays in the sum, where it rounds as well as adding a half: a term is one
        // `smlal`.
        let sum = terms.iter().rev().fold(1 << 31, |sum: i64, term| {
            ((i64::from(term.0) << 32) | (sum & 0xFFFF_FFFF)).wrapping_add((sum >> 32) * i64::from(x))
        });
        (sum >> 32) as i32
    }
}

/// Converts a polynomial's terms to fixed point at compile time.
const fn fixed(terms: Terms<Constant>) -> Terms<Q> {
    let mut fixed = [Q(0); 7];
    let mut k = 0;
    while k < terms.len() {
        fixed[k] = terms[k].q;
        k += 1;
    }
    fixed
}

impl FusedOps for Q {
    // Not inlined: for terms of known sign the compiler replaces `smlal` by longer sequences.
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
    fn rotate_clockwise(x: Self, y: Self, sin: Self, cos: Self) -> (Self, Self) {
        let minus_sin = Self(sin.0.wrapping_neg());
        let (across, along) = (Self::sum(0, &([x, y], [cos, sin])), Self::sum(0, &([y, x], [cos, minus_sin])));
        if Self::all_fit(&[across, along]) {
            (Self::narrow(across), Self::narrow(along))
        } else {
            Self::saturated_rotation(x, y, sin, cos)
        }
    }

    #[inline]
    fn dot<const K: usize>(a: [Self; K], b: [Self; K]) -> Self {
        Self::rounded_dot(a, b)
    }

    #[inline]
    fn mul_unchecked_range(self, other: Self) -> Self {
        Self::narrow(Self::sum(0, &([self], [other])))
    }

    #[inline]
    fn eval_quadratic(value: i32, shift: u32, [c0, c1, c2]: &[Self; 3], limit: Constant) -> Option<Self> {
        let u = Self(value.wrapping_shl(Self::FRACTION_BITS.wrapping_sub(shift)));
        let slope = c1.0.wrapping_add(Self::narrow(i64::from(c2.0) * i64::from(u.0)).0);
        let sum = Self::sum(c0.wide() + Self::HALF, &([u], [Self(slope)]));
        // The upper word suffices for the comparison.
        let (upper, limit) = ((sum >> 32) as i32, limit.q.0 >> (32 - Self::FRACTION_BITS));
        (upper ^ (upper >> 31) < limit).then_some(Self::narrow(sum))
    }

    // Called twice a segment; as a function, a fifth of it would save registers.
    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    fn gain_over_innovation_variance(self, r: Self, h: Self) -> Self {
        let den = Self::narrow(r.wide() + i64::from(self.0) * i64::from(h.0));
        div_approx::<{ Self::FRACTION_BITS }>(self.0 as u32, den.0 as u32)
            .map_or_else(|| self.divided(den), |bits| Self(bits as i32))
    }

    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    fn kalman_update<const D: usize>(
        x: [Self; D],
        ratio: Self,
        weights: &[Self; 3],
        [a, b]: [[Self; D]; 2],
    ) -> [Self; D] {
        let (mut innovations, mut sums) = ([0; D], [0; D]);
        for k in 0..D {
            innovations[k] = Self::sum(0, &(*weights, [a[k], b[k], x[k]]));
            sums[k] = Self::sum(x[k].wide() + Self::HALF, &([ratio], [Self::narrow(innovations[k])]));
        }
        let fit = Self::all_fit(&innovations) & Self::all_fit(&sums);
        let mut values = [Self(0); D];
        for k in 0..D {
            values[k] = if fit { Self::narrow(sums[k]) } else { x[k].saturated_update(ratio, weights, a[k], b[k]) };
        }
        values
    }

    #[inline(never)]
    fn subtract_products(values: &mut [Self], others: &[Self], factor: Self) {
        // Just under a half rounds the difference down where the operator rounds the product up.
        const ROUND: i64 = Q::HALF - 1;
        let minus = Self(factor.0.saturating_neg());
        for (value, other) in values.iter_mut().zip(others) {
            let sum = Self::sum(value.wide() + ROUND, &([*other], [minus]));
            *value = if Self::all_fit(&[sum]) {
                Self::narrow(sum)
            } else {
                Self::saturated_difference(*value, *other, factor)
            };
        }
    }

    #[inline(never)]
    fn divide_all(values: &mut [Self], divisor: Self) {
        if divisor.0 <= 0 {
            return plain::divide_all(values, divisor);
        }
        let by = Divisor::<{ Self::FRACTION_BITS }>::new(divisor.0 as u32);
        for value in values {
            let quotient = by.divide(value.0.unsigned_abs());
            let signed = quotient as i32;
            *value = if signed < 0 {
                Self::overflowed(value.0 < 0)
            } else {
                Self(if value.0 < 0 { -signed } else { signed })
            };
        }
    }

    #[inline]
    fn share_of_unwrapped(remainder: Self, whole_turns: i32) -> Self {
        let total = i64::from(remainder.0) + i64::from(TWO_PI.q.0) * i64::from(whole_turns);
        let excess = 33_u32.saturating_sub(total.unsigned_abs().leading_zeros());
        Self(remainder.0 >> excess) / Self((total >> excess) as i32)
    }
}
