//! Angles as whole numbers: wrapping is integer overflow, unwrapping and long sums are exact for ever.
//!
//! A heading that drifts by 45° in 15 min has turned by 75 rad in a day. As a float it loses digits, as fixed point it
//! overflows; as a count of 2⁻³² turns in 64 bits it stays exact to 1.5 nrad for longer than any arm lives.

use core::f64::consts::TAU;
use core::ops::{Add, Neg, Sub};

use crate::fixed::divide;
use crate::scalar::{Scalar, TWO_PI};

/// 2⁻³² turns in a turn.
const TURN: f64 = 4_294_967_296.0;

/// A direction: a fraction of a turn in units of 2⁻³² turns, −½…½, that wraps by itself. Clockwise positive.
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
    /// From units of 2⁻³² turns.
    #[must_use]
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// In units of 2⁻³² turns.
    #[must_use]
    pub const fn bits(self) -> i32 {
        self.0
    }

    /// From an angle in degrees; whole turns are dropped. For tables and recorded sessions.
    #[must_use]
    pub fn from_degrees(degrees: f64) -> Self {
        Self(round_to_i64(degrees / 360.0 * TURN) as i32)
    }

    /// From an angle in rad; whole turns are dropped. For tables and recorded sessions.
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
    #[must_use]
    pub fn atan2(y: i64, x: i64) -> Option<Self> {
        let longest = x.unsigned_abs().max(y.unsigned_abs());
        if longest == 0 {
            return None;
        }
        let (abs_y, abs_x) = (scale(y.unsigned_abs(), longest), scale(x.unsigned_abs(), longest));
        // Fold the first quadrant on |angle| ≤ π/8 about 0, π/4 or π/2, where six terms of atan suffice.
        let (base, num, den) = if abs_y < times_tan_eighth(abs_x) {
            (0, i64::from(abs_y), abs_x)
        } else if abs_x < times_tan_eighth(abs_y) {
            (QUARTER_TURN, -i64::from(abs_x), abs_y)
        } else {
            (QUARTER_TURN / 2, i64::from(abs_y) - i64::from(abs_x), abs_x + abs_y)
        };
        let ratio = i64::from(divide(num.unsigned_abs() as u32, den, 31));
        let first = base + if num < 0 { -atan_turns(ratio) } else { atan_turns(ratio) };
        let upper = if x < 0 { 2 * QUARTER_TURN - first } else { first };
        // The cast wraps +½ turn to −½, the same direction.
        Some(Self((if y < 0 { -upper } else { upper }) as i32))
    }
}

impl Sub for Phase {
    type Output = Self;

    /// The shorter way from `other` to here.
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

/// A quarter turn in units of 2⁻³² turns.
const QUARTER_TURN: i64 = 1 << 30;

/// Scales `value` so that `longest` gets 31 bits and a sum of two such values fits in 32.
fn scale(value: u64, longest: u64) -> u32 {
    let zeros = longest.leading_zeros();
    (if zeros > 33 { value << (zeros - 33) } else { value >> (33 - zeros) }) as u32
}

/// `value · tan(π/8)`, rounded down.
fn times_tan_eighth(value: u32) -> u32 {
    const TAN_EIGHTH: u64 = 1_779_033_704; // √2 − 1 in units of 2⁻³²
    ((u64::from(value) * TAN_EIGHTH) >> 32) as u32
}

/// atan of `ratio` (2⁻³¹, 0…tan(π/8)) in units of 2⁻³² turns: minimax polynomial in the square, error 6·10⁻¹⁰ rad.
fn atan_turns(ratio: i64) -> i64 {
    // Turns in units of 2⁻³³.
    const TERMS: [i64; 6] = [1_367_130_550, -455_709_838, 273_402_024, -194_685_271, 144_584_902, -82_577_231];
    let square = (ratio * ratio) >> 31;
    let sum = TERMS.iter().rev().fold(0, |sum, term| term + ((sum * square) >> 31));
    (ratio * sum) >> 32
}

/// An unwrapped angle in units of 2⁻³² turns, over ±2³¹ turns. Clockwise positive.
///
/// Sums and differences are exact, so that a window's mean does not wander however long the session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Turns(i64);

impl Turns {
    /// No turn at all.
    pub const ZERO: Self = Self(0);

    /// From units of 2⁻³² turns.
    #[must_use]
    pub const fn from_bits(bits: i64) -> Self {
        Self(bits)
    }

    /// In units of 2⁻³² turns.
    #[must_use]
    pub const fn bits(self) -> i64 {
        self.0
    }

    /// From an angle in rad, rounded to nearest.
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
    pub const fn whole(self) -> i32 {
        ((self.0.wrapping_sub(self.0 as i32 as i64)) >> 32) as i32
    }

    /// The angle without its sign.
    #[must_use]
    pub const fn magnitude(self) -> Self {
        Self(self.0.saturating_abs())
    }

    /// `self / count`, rounded towards zero, for `count` of 1 to 65 535; zero for a `count` of 0.
    ///
    /// Schoolbook division by 16-bit digits: the Cortex-M3 divides 32 bits in hardware, 64 bits it does not.
    #[must_use]
    pub fn mean_of(self, count: u16) -> Self {
        if count == 0 {
            return Self::ZERO;
        }
        let (magnitude, divisor) = (self.0.unsigned_abs(), u32::from(count));
        let (mut quotient, mut rest) = (0_u64, 0_u32);
        for shift in [48, 32, 16, 0] {
            let part = (rest << 16) | ((magnitude >> shift) as u32 & 0xFFFF);
            quotient = (quotient << 16) | u64::from(part / divisor);
            rest = part % divisor;
        }
        Self(if self.0 < 0 { (quotient as i64).wrapping_neg() } else { quotient as i64 })
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

/// A bend angle θ = `rest` + 2π·`turns`, rad, clockwise positive: whole turns beside the remainder.
///
/// Only IMU angles have turns, once they have drifted past 180°: raw ones, and corrected ones that nothing anchors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle<S> {
    /// The angle without the turns, rad.
    pub rest: S,
    /// Whole turns on top of it.
    pub turns: i32,
}

impl<S: Scalar> Angle<S> {
    /// The whole angle as one scalar, rad; it saturates where `S` does ([`Q`](crate::Q): ±32 rad).
    #[must_use]
    pub fn value(self) -> S {
        if self.turns == 0 { self.rest } else { self.rest + S::constant(TWO_PI) * S::from_int(self.turns) }
    }

    /// The whole angle as a float, rad. For reports.
    #[must_use]
    pub fn rad(self) -> f64 {
        self.rest.to_f64() + TAU * f64::from(self.turns)
    }
}

impl<S: Scalar> From<Turns> for Angle<S> {
    fn from(turns: Turns) -> Self {
        Self { rest: S::from_phase(turns.phase()), turns: turns.whole() }
    }
}

impl<S> From<S> for Angle<S> {
    fn from(rad: S) -> Self {
        Self { rest: rad, turns: 0 }
    }
}
