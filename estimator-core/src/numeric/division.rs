//! Division on a core that divides only 32 bits by 32.

/// `num · 2^FRAC / den`, rounded to nearest (a half upwards); `u32::MAX` where the quotient does not fit 32 bits.
///
/// `num` and `den` are at most 2³¹, `FRAC` is at most 31. About 30 instructions on a Cortex-M3, where a 64-bit division
/// takes hundreds.
#[inline]
pub(crate) fn divide<const FRAC: u32>(num: u32, den: u32) -> u32 {
    if den == 0 {
        return u32::MAX;
    }
    Divisor::<FRAC>::new(den).divide(num)
}

/// Divisor with its reciprocal, for several quotients.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Divisor<const FRAC: u32> {
    den: u32,
    zeros: u32,
    reciprocal: u32,
}

impl<const FRAC: u32> Divisor<FRAC> {
    /// Computes the reciprocal of `den`, 1 to 2³¹.
    #[inline]
    pub fn new(den: u32) -> Self {
        let zeros = den.leading_zeros();
        Self { den, zeros, reciprocal: reciprocal(den.wrapping_shl(zeros)) }
    }

    /// As [`divide`], in half the instructions.
    #[inline]
    pub fn divide(&self, num: u32) -> u32 {
        let num_zeros = (num | 1).leading_zeros();
        let shift = (num_zeros + 31 - FRAC).wrapping_sub(self.zeros);
        let quotient = match shift {
            0..32 => upper_word(num << num_zeros, self.reciprocal) >> shift,
            32..64 => 0,
            _ => return u32::MAX,
        };
        // The quotient is never too large, and so little too small that the remainder fits 32 bits.
        let remainder = (num << FRAC).wrapping_sub(quotient.wrapping_mul(self.den));
        quotient.wrapping_add(remainder.wrapping_add(self.den / 2) / self.den)
    }
}

/// `num · 2^FRAC / den`, too small by a unit and its 2²⁸th part at most. `None` for a `den` of 0, a quotient from 2³¹ on,
/// and some quotients below 1 or from 2³⁰ on. Two thirds of the instructions of [`divide`].
#[inline]
pub(crate) fn div_approx<const FRAC: u32>(num: u32, den: u32) -> Option<u32> {
    let (num_zeros, den_zeros) = (num.leading_zeros(), den.leading_zeros());
    let shift = (num_zeros + 31 - FRAC).wrapping_sub(den_zeros);
    let normal = den.wrapping_shl(den_zeros);
    let (first, error) = reciprocal_seed(normal);
    let quotient = upper_word(num.wrapping_shl(num_zeros), first.wrapping_add(upper_word(first, error)));
    (den != 0 && (1..32).contains(&shift)).then(|| quotient.wrapping_shr(shift))
}

/// 2⁶³ / `normal`, whose highest bit is set: never too large, and too small by 4 at most.
///
/// The hardware divider yields 15 bits of the reciprocal r; one step of third order, r + r e + r e² with the error
/// e = 1 − r `normal`, yields the others.
#[inline]
pub(crate) fn reciprocal(normal: u32) -> u32 {
    let (first, error) = reciprocal_seed(normal);
    first.wrapping_add(upper_word(first, error.wrapping_add(upper_word(error, error))))
}

/// The 15 bits of [`reciprocal`] from the hardware divider, and their error in units of 2⁻³², rounded down.
#[inline]
fn reciprocal_seed(normal: u32) -> (u32, u32) {
    let first = (u32::MAX / ((normal >> 16) + 1)) << 15;
    (first, !upper_word(first, normal) << 1)
}

/// The upper 32 bits of a product.
#[inline]
pub(crate) fn upper_word(a: u32, b: u32) -> u32 {
    ((u64::from(a) * u64::from(b)) >> 32) as u32
}

/// The upper 32 bits of a product with signs.
#[inline]
pub(crate) fn signed_upper_word(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 32) as i32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{div_approx, divide, reciprocal};

    const FRAC: u32 = 26;
    const MAX: u32 = 1 << 31;

    fn exact(num: u32, den: u32) -> u32 {
        let (num, den) = (u128::from(num) << FRAC, u128::from(den));
        ((2 * num + den) / (2 * den)).min(u128::from(u32::MAX)) as u32
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn rounds_every_quotient_to_nearest(num in 0..=MAX, den in 0..=MAX, num_shift in 0_u32..32, den_shift in 0_u32..32) {
            let (num, den) = (num >> num_shift, (den >> den_shift).max(1));
            let (quotient, exact) = (divide::<FRAC>(num, den), exact(num, den));
            prop_assert_eq!(quotient.min(MAX), exact.min(MAX));
        }

        #[test]
        fn a_near_quotient_is_a_unit_too_small_at_most(num in 0..=MAX, den in 1..=MAX, num_shift in 0_u32..32, den_shift in 0_u32..32) {
            let (num, den) = (num >> num_shift, (den >> den_shift).max(1));
            let exact = (u64::from(num) << FRAC) / u64::from(den);
            if let Some(quotient) = div_approx::<FRAC>(num, den) {
                let missing = exact - u64::from(quotient);
                prop_assert!(missing <= 1 + (exact >> 28), "{} missing of {}", missing, exact);
            } else {
                prop_assert!(exact == 0 || exact >= 1 << 30, "no quotient for {}", exact);
            }
        }

        #[test]
        fn a_reciprocal_is_at_most_4_too_small(bits: u32, shift in 0_u32..32) {
            let normal = (bits >> shift) | MAX;
            let missing = (1_u64 << 63) / u64::from(normal) - u64::from(reciprocal(normal));
            prop_assert!(missing <= 4, "{} missing", missing);
        }
    }

    #[test]
    fn holds_at_the_edges() {
        let edges = [1, 2, 3, 0x0001_FFFF, 0x0002_0000, 0x3FFF_FFFF, 0x4000_0000, 0x4000_0001, 0x7FFF_FFFF, MAX];
        for (num, den) in edges.iter().flat_map(|num| edges.iter().map(move |den| (*num, *den))) {
            assert_eq!(divide::<FRAC>(num, den).min(MAX), exact(num, den).min(MAX), "{num} / {den}");
        }
    }

    #[test]
    fn takes_a_zero_divisor_for_an_infinite_quotient() {
        assert_eq!(divide::<FRAC>(0, 0), u32::MAX);
    }
}
