//! The board's number against exact integer arithmetic.

use std::f64::consts::{PI, TAU};

use estimator_core::{FusedOps, Phase, Q, Scalar};
use num_traits::{One, Zero};
use proptest::prelude::*;

const LSB: f64 = 1.0 / 67_108_864.0;
const ONE: i128 = 1 << Q::FRACTION_BITS;
/// Rounding error of a conversion to 2⁻³² turns: half a unit, rad.
const HALF_TURN_UNIT: f64 = TAU / 8_589_934_592.0;

/// The nearest Q to a count of units, of any size.
fn saturated(bits: i128) -> Q {
    Q::from_bits(bits.clamp(i128::from(i32::MIN), i128::from(i32::MAX)) as i32)
}

/// All magnitudes equally often, where `any` would give hardly a number below 1.
fn q() -> impl Strategy<Value = Q> {
    (any::<i32>(), 0..32).prop_map(|(bits, shift)| Q::from_bits(bits >> shift))
}

fn wide(value: Q) -> i128 {
    i128::from(value.to_bits())
}

proptest! {
    #[test]
    fn adds_and_saturates(a in q(), b in q()) {
        prop_assert_eq!(a + b, saturated(wide(a) + wide(b)));
        let mut sum = a;
        sum += b;
        prop_assert_eq!(sum, a + b);
    }

    #[test]
    fn subtracts_and_saturates(a in q(), b in q()) {
        prop_assert_eq!(a - b, saturated(wide(a) - wide(b)));
        let mut difference = a;
        difference -= b;
        prop_assert_eq!(difference, a - b);
    }

    #[test]
    fn multiplies_to_nearest_with_halves_upwards_and_saturates(a in q(), b in q()) {
        prop_assert_eq!(a * b, saturated((2 * wide(a) * wide(b) + ONE).div_euclid(2 * ONE)));
        let mut product = a;
        product *= b;
        prop_assert_eq!(product, a * b);
    }

    #[test]
    fn sums_of_products_are_rounded_once_and_saturate(a in [q(), q(), q()], b in [q(), q(), q()]) {
        let sum = a.iter().zip(b).map(|(a, b)| wide(*a) * wide(b)).sum::<i128>();
        prop_assert_eq!(Q::dot(a, b), saturated((2 * sum + ONE).div_euclid(2 * ONE)));
    }

    /// Sums of products are cut off, but where one saturates; sine and cosine are within ±1.
    #[test]
    fn turns_vectors_clockwise_and_saturates(x in q(), y in q(), angle in -PI..PI) {
        let (sin, cos) = (Q::from_f64(angle.sin()), Q::from_f64(angle.cos()));
        let sums = [wide(x) * wide(cos) + wide(y) * wide(sin), wide(y) * wide(cos) - wide(x) * wide(sin)];
        let (across, along) = Q::rotate_clockwise(x, y, sin, cos);
        for (turned, sum) in [across, along].into_iter().zip(sums) {
            prop_assert!((wide(turned) - wide(saturated(sum.div_euclid(ONE)))).abs() <= 1);
        }
    }

    #[test]
    fn divides_to_nearest_with_halves_away_from_zero_and_saturates(a in q(), b in q()) {
        if b.is_zero() {
            return Ok(());
        }
        let (num, den) = (wide(a).abs() * ONE, wide(b).abs());
        let magnitude = (2 * num + den) / (2 * den);
        prop_assert_eq!(a / b, saturated(if (wide(a) < 0) == (wide(b) < 0) { magnitude } else { -magnitude }));
    }

    #[test]
    fn a_division_by_zero_is_the_largest_number_of_the_sign(a in q()) {
        prop_assert_eq!(a / Q::zero(), if wide(a) < 0 { Q::MIN } else { Q::MAX });
    }

    #[test]
    fn negates_and_saturates(a in q()) {
        prop_assert_eq!(-a, saturated(-wide(a)));
    }

    #[test]
    fn orders_as_the_numbers_do(a in q(), b in q()) {
        prop_assert_eq!(a.cmp(&b), wide(a).cmp(&wide(b)));
        let limit = Q::from_bits((b.to_bits() | 1).saturating_abs());
        prop_assert_eq!(a.is_within(limit), -wide(limit) <= wide(a) && wide(a) < wide(limit));
    }

    #[test]
    fn floats_hold_it_exactly(a in q()) {
        prop_assert_eq!(Q::from_f64(a.to_f64()), a);
    }

    #[test]
    fn a_float_is_rounded_to_nearest(value in -31.99..31.99) {
        prop_assert!((Q::from_f64(value).to_f64() - value).abs() <= LSB / 2.0);
    }

    #[test]
    fn a_fraction_is_exact(value in -4096..4096, shift in 7_u32..=12) {
        prop_assert_eq!(wide(Q::from_fraction(value, shift)) << shift, i128::from(value) * ONE);
    }

    #[test]
    fn rounds_to_the_nearest_whole_number(a in q()) {
        prop_assert!((f64::from(Scalar::round(a)) - a.to_f64()).abs() <= 0.5);
    }

    /// Half a step of Q; the factor 2π/64 itself is held to 4e-11.
    #[test]
    fn a_phase_becomes_the_nearest_angle(bits: i32) {
        let phase = Phase::from_bits(bits);
        prop_assert!((Q::from_phase(phase).to_f64() - phase.rad()).abs() <= LSB / 2.0 + 2e-10);
    }

    /// Half a unit of turns, and the factor 64/2π held to 3.7e-10 of the angle.
    #[test]
    fn an_angle_becomes_the_nearest_turns(a in q()) {
        let error = (a.to_turns().rad() - a.to_f64()).abs();
        prop_assert!(error <= HALF_TURN_UNIT + 3.7e-10 * a.to_f64().abs(), "{} rad", error);
    }

    /// There half a step of Q is lost, back half a unit of turns and 3.7e-10 of up to π.
    #[test]
    fn a_phase_survives_the_way_to_an_angle_and_back(bits: i32) {
        let phase = Phase::from_bits(bits);
        let error = (Q::from_phase(phase).to_turns().phase() - phase).rad().abs();
        prop_assert!(error <= LSB / 2.0 + HALF_TURN_UNIT + 1.4e-9, "{} rad", error);
    }

    /// `remainder` may be half a step off the rounding of 2π·`whole_turns`; the quotient is as good as 26 bits allow.
    #[test]
    fn the_share_of_an_unwrapped_angle_is_that_of_floats(rest in -3.1..3.1, turns in prop_oneof![-9..0, 1..9, 100..10_000]) {
        let exact = <f64 as FusedOps>::share_of_unwrapped(rest, turns);
        let share = Q::share_of_unwrapped(Q::from_f64(rest), turns).to_f64();
        prop_assert!((share - exact).abs() <= 2.0 * LSB, "{} instead of {}", share, exact);
    }
}

#[test]
fn a_float_out_of_range_saturates_and_nan_is_zero() {
    assert_eq!(Q::from_f64(32.0), Q::MAX);
    assert_eq!(Q::from_f64(-33.0), Q::MIN);
    assert_eq!(Q::from_f64(f64::INFINITY), Q::MAX);
    assert_eq!(Q::from_f64(f64::NAN), Q::zero());
}

#[test]
fn sums_of_the_largest_products_saturate() {
    for (a, b, expected) in [(Q::MIN, Q::MIN, Q::MAX), (Q::MIN, Q::MAX, Q::MIN), (Q::MAX, Q::MAX, Q::MAX)] {
        assert_eq!((Q::dot([a], [b]), Q::dot([a; 2], [b; 2]), Q::dot([a; 3], [b; 3])), (expected, expected, expected));
    }
}

#[test]
fn a_whole_number_is_exact_and_saturates() {
    assert_eq!(Q::from_int(-32), Q::MIN);
    assert_eq!(Q::from_int(31).to_bits(), 31 << 26);
    assert_eq!(Q::from_int(32), Q::MAX);
    assert_eq!(Q::from_int(i32::MIN), Q::MIN);
}

#[test]
fn one_and_zero_are_neutral() {
    let value = Q::from_f64(-0.7);
    assert_eq!((value * Q::one(), value / Q::one(), value + Q::zero()), (value, value, value));
}
