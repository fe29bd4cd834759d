//! Division on a core that divides only 32 bits by 32.

/// `num · 2^frac / den`, rounded to nearest (a half upwards); `u32::MAX` where the quotient does not fit 32 bits.
///
/// `frac` is at most 31. A reciprocal of 15 bits from the hardware divider, two Newton steps, and the remainder settles
/// what is left: about 40 instructions on a Cortex-M3, where a 64-bit division takes hundreds.
#[inline]
pub(crate) fn divide(num: u32, den: u32, frac: u32) -> u32 {
    if u64::from(num) >> (32 - frac) >= u64::from(den) {
        return u32::MAX;
    }
    let zeros = den.leading_zeros();
    let normal = den << zeros;
    // The highest bit is set; saying so spares the check for a division by zero.
    let mut reciprocal = u64::from(u32::MAX / ((normal >> 16) | 0x8000)) << 15; // 2⁶³ / normal
    for _ in 0..2 {
        let error = (1_u64 << 63).wrapping_sub(u64::from(normal) * reciprocal) as i64;
        let step = ((reciprocal as i64) * (error >> 31)) >> 32;
        reciprocal = reciprocal.saturating_add_signed(step).min(u64::from(u32::MAX));
    }
    let mut quotient = (u64::from(num) * reciprocal) >> (63 - zeros - frac);
    let mut rest = (u64::from(num) << frac).wrapping_sub(quotient.wrapping_mul(u64::from(den))) as i64;
    // Bounded: an open loop of subtractions is what compilers turn into a 64-bit division.
    for _ in 0..2 {
        if rest < 0 {
            quotient -= 1;
            rest += i64::from(den);
        } else if rest >= i64::from(den) {
            quotient += 1;
            rest -= i64::from(den);
        }
    }
    (quotient + u64::from(2 * rest >= i64::from(den))).min(u64::from(u32::MAX)) as u32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::divide;

    fn exact(num: u32, den: u32, frac: u32) -> u32 {
        let (num, den) = (u128::from(num) << frac, u128::from(den));
        ((2 * num + den) / (2 * den)).min(u128::from(u32::MAX)) as u32
    }

    proptest! {
        #[test]
        fn rounds_every_quotient_to_nearest(num: u32, den in 1_u32.., shift in 0_u32..32, frac in 0_u32..32) {
            let den = (den >> shift).max(1);
            prop_assert_eq!(divide(num, den, frac), exact(num, den, frac));
        }
    }

    #[test]
    fn holds_at_the_edges() {
        let edges = [1, 2, 3, 0x7FFF_FFFF, 0x8000_0000, 0x8000_0001, 0xFFFE_FFFF, 0xFFFF_0000, u32::MAX];
        for (num, den) in edges.iter().flat_map(|num| edges.iter().map(move |den| (*num, *den))) {
            for frac in 0..32 {
                assert_eq!(divide(num, den, frac), exact(num, den, frac), "{num} / {den} with {frac} bits");
            }
        }
    }

    #[test]
    fn takes_a_zero_divisor_for_an_infinite_quotient() {
        assert_eq!(divide(0, 0, 26), u32::MAX);
    }
}
