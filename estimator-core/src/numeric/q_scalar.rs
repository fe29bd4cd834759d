//! [`Scalar`] of the fixed-point number.

use crate::numeric::phase::{Phase, Turns};
use crate::numeric::q::Q;
use crate::numeric::scalar::{Constant, Scalar};

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
