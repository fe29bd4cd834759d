//! Angles as integers: wrapping is integer overflow, and unwrapping and sums over any time are exact.
//!
//! A heading that drifts by 45° in 15 min has turned by 75 rad in a day. As a float it loses digits, as fixed point it
//! overflows; as a count of 2⁻³² turns in 64 bits it stays exact to 1.5 nrad for longer than any arm lives.

use core::f64::consts::TAU;
use core::ops::{Add, Neg, Sub};

use crate::numeric::division::{reciprocal, signed_upper_word, upper_word};

/// 2⁻³² turns in a turn.
const TURN: f64 = 4_294_967_296.0;

/// A direction: a fraction of a turn in units of 2⁻³² turns, −½…½, that wraps by integer overflow. Clockwise positive.
///
/// ```
/// use estimator_core::Phase;
///
/// let step = Phase::from_degrees(359.0) - Phase::from_degrees(1.0);
/// assert!((step.rad().to_degrees() + 2.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Phase(i32);

impl Phase {
    /// Converts from units of 2⁻³² turns.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// Returns the angle in units of 2⁻³² turns.
    #[must_use]
    pub const fn bits(self) -> i32 {
        self.0
    }

    /// Converts from an angle in degrees; whole turns are dropped. For tables and recorded sessions.
    #[must_use]
    pub fn from_degrees(degrees: f64) -> Self {
        Self(round_to_i64(degrees / 360.0 * TURN) as i32)
    }

    /// Converts from an angle in rad; whole turns are dropped. For tables and recorded sessions.
    #[must_use]
    pub fn from_rad(rad: f64) -> Self {
        Turns::from_rad(rad).phase()
    }

    /// The angle in rad, −π…π.
    #[must_use]
    pub fn rad(self) -> f64 {
        f64::from(self.0) * (TAU / TURN)
    }

    /// The direction of the vector (`x`, `y`), counter-clockwise from the x axis in the sense of `atan2(y, x)`, to
    /// 3 nrad, two units; `None` for the zero vector. Constant time but for two branches, without 64-bit division.
    #[inline]
    #[must_use]
    pub fn atan2(y: i64, x: i64) -> Option<Self> {
        let (abs_y, abs_x) = (y.unsigned_abs(), x.unsigned_abs());
        // Half of a unit quaternion's vector, in units of 2⁻⁶⁰, unless it is steep.
        let (abs_y, abs_x) = match abs_y.wrapping_add(abs_x) >> 58 {
            1..4 => ((abs_y >> 28) as u32, (abs_x >> 28) as u32),
            _ => scaled(abs_y, abs_x)?,
        };
        // Fold the first quadrant on |angle| ≤ π/8 about 0, π/4 or π/2, where six terms of atan suffice.
        let (base, num, den) = if abs_y < times_tan_eighth(abs_x) {
            (0, abs_y as i32, abs_x)
        } else if abs_x < times_tan_eighth(abs_y) {
            (QUARTER_TURN, (abs_x as i32).wrapping_neg(), abs_y)
        } else {
            (QUARTER_TURN / 2, abs_y.wrapping_sub(abs_x) as i32, abs_x.wrapping_add(abs_y))
        };
        let zeros = den.leading_zeros();
        let ratio = upper_word(num.unsigned_abs() << zeros, reciprocal(den << zeros));
        let ratio = atan_turns(ratio.wrapping_add(ROUNDED_DOWN) as i32);
        let first = base.wrapping_add(if num < 0 { -ratio } else { ratio });
        // Half a turn is −½, by integer overflow.
        let upper = if x < 0 { i32::MIN.wrapping_sub(first) } else { first };
        Some(Self(if y < 0 { upper.wrapping_neg() } else { upper }))
    }
}

/// The vector scaled to fit 32 bits, the longer component to 31 bits; `None` for the zero vector.
#[cold]
fn scaled(y: u64, x: u64) -> Option<(u32, u32)> {
    let longest = x.max(y);
    let zeros = longest.leading_zeros();
    let scale = |value: u64| (if zeros > 33 { value << (zeros - 33) } else { value >> (33 - zeros) }) as u32;
    (longest > 0).then(|| (scale(y), scale(x)))
}

impl Sub for Phase {
    type Output = Self;

    /// The shorter way from `other` to here.
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

/// A quarter turn in units of 2⁻³² turns.
const QUARTER_TURN: i32 = 1 << 30;

/// `value · tan(π/8)`, rounded down.
#[inline]
fn times_tan_eighth(value: u32) -> u32 {
    const TAN_EIGHTH: u32 = 1_779_033_704; // √2 − 1 in units of 2⁻³²
    upper_word(value, TAN_EIGHTH)
}

/// Mean rounding error of the ratio in atan2, which is rounded down, in units of 2⁻³¹.
const ROUNDED_DOWN: u32 = 3;

/// atan of `ratio` (2⁻³¹, 0…tan(π/8)) in units of 2⁻³² turns: minimax polynomial in the square, error 6·10⁻¹⁰ rad.
#[inline]
fn atan_turns(ratio: i32) -> i32 {
    // Turns in units of 2⁻³³.
    const TERMS: [i32; 6] = [1_367_130_550, -455_709_838, 273_402_024, -194_685_271, 144_584_902, -82_577_231];
    // In units of 2⁻³², so that the upper word of a product is the result; tan²(π/8) is under a half.
    let square = upper_word(2 * ratio as u32, 2 * ratio as u32) as i32;
    let sum = TERMS.iter().rev().fold(0, |sum, term| term + signed_upper_word(sum, square));
    signed_upper_word(ratio, sum)
}

/// An unwrapped angle in units of 2⁻³² turns, over ±2³¹ turns. Clockwise positive.
///
/// Sums and differences are exact, so that a window's mean does not drift over a long session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Turns(i64);

impl Turns {
    /// Zero.
    pub const ZERO: Self = Self(0);

    /// Converts from units of 2⁻³² turns.
    #[must_use]
    pub const fn from_bits(bits: i64) -> Self {
        Self(bits)
    }

    /// Returns the angle in units of 2⁻³² turns.
    #[must_use]
    pub const fn bits(self) -> i64 {
        self.0
    }

    /// Converts from an angle in rad, rounded to nearest.
    #[must_use]
    pub fn from_rad(rad: f64) -> Self {
        Self(round_to_i64(rad * (TURN / TAU)))
    }

    /// The angle in rad.
    #[must_use]
    pub fn rad(self) -> f64 {
        self.0 as f64 * (TAU / TURN)
    }

    /// The direction alone, without its whole turns.
    #[must_use]
    pub const fn phase(self) -> Phase {
        Phase(self.0 as i32)
    }

    /// The whole turns that [`Turns::phase`] leaves out.
    #[must_use]
    pub const fn whole_turns(self) -> i32 {
        ((self.0.wrapping_sub(self.0 as i32 as i64)) >> 32) as i32
    }

    /// The angle without its sign.
    #[must_use]
    pub const fn magnitude(self) -> Self {
        Self(self.0.saturating_abs())
    }

    /// Returns `true` if the magnitude of the angle is over `limit`, which is not negative.
    #[must_use]
    pub const fn exceeds(self, limit: Self) -> bool {
        self.0.unsigned_abs() > limit.0 as u64
    }

    /// The angle within a turn times a factor in units of 2⁻³².
    #[must_use]
    pub const fn scaled_by(self, factor: i32) -> Self {
        Self((self.0 as i32 as i64 * factor as i64) >> 32)
    }

    /// The angle if all bits of the mask are set, zero if none is.
    #[inline]
    pub(crate) fn masked(self, mask: i32) -> Self {
        Self(self.0 & i64::from(mask))
    }

    /// `self / count`, rounded down, for `count` of 1 to 65 535; zero for a `count` of 0.
    ///
    /// Long division by 16-bit digits: the Cortex-M3 divides 32 bits in hardware, but not 64 bits.
    #[inline]
    #[must_use]
    pub fn mean_of(self, count: u16) -> Self {
        if count == 0 {
            return Self::ZERO;
        }
        let (divisor, upper, lower) = (i32::from(count), (self.0 >> 32) as i32, self.0 as u32);
        // The first digit is the only signed one; it is rounded down.
        let (first, remainder) = (upper / divisor, upper % divisor);
        let (first, remainder) = (first + (remainder >> 31), (remainder + (divisor & (remainder >> 31))) as u32);
        let divisor = divisor as u32;
        let part = (remainder << 16) | (lower >> 16);
        let last = ((part % divisor) << 16) | (lower & 0xFFFF);
        let quotient = ((part / divisor) << 16) | (last / divisor);
        Self((i64::from(first) << 32) | i64::from(quotient))
    }
}

impl From<Phase> for Turns {
    fn from(phase: Phase) -> Self {
        Self(i64::from(phase.0))
    }
}

impl Add for Turns {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

impl Sub for Turns {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

impl Neg for Turns {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

fn round_to_i64(value: f64) -> i64 {
    (value + if value < 0.0 { -0.5 } else { 0.5 }) as i64
}
