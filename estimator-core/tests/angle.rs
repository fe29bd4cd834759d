//! Angles as integers: exact, and wrapped only where specified.

use std::f64::consts::{PI, TAU};

use estimator_core::{Angle, Phase, Q, Turns};
use proptest::prelude::*;

/// One unit of 2⁻³² turns, rad.
const UNIT: f64 = TAU / 4_294_967_296.0;

/// Two units: the ratio, the polynomial and the result are each rounded down. Over 6·10⁷ vectors the largest error is
/// 2.8 nrad.
const ATAN2_ERROR: f64 = 2.0 * UNIT;

/// Distance between two directions, rad.
fn apart(one: f64, other: f64) -> f64 {
    let turns = (one - other) / TAU;
    ((turns - turns.round()) * TAU).abs()
}

/// Whole numbers of all magnitudes.
fn component() -> impl Strategy<Value = i64> {
    (any::<i64>(), 0..64).prop_map(|(bits, shift)| bits >> shift)
}

fn assert_atan2(y: i64, x: i64) {
    let angle = Phase::atan2(y, x).expect("not the zero vector").rad();
    let error = apart(angle, (y as f64).atan2(x as f64));
    assert!(error <= ATAN2_ERROR, "atan2({y}, {x}) is off by {error} rad");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn atan2_is_within_two_units_at_any_length(y in component(), x in component()) {
        prop_assume!((y, x) != (0, 0));
        assert_atan2(y, x);
    }

    #[test]
    fn atan2_is_within_two_units_all_around(angle in -PI..PI, length in 1e9..9e18) {
        assert_atan2((length * angle.sin()) as i64, (length * angle.cos()) as i64);
    }

    #[test]
    fn the_mean_of_turns_is_the_exact_quotient_rounded_down(bits: i64, shift in 0..64, count in 1_u16..) {
        let sum = Turns::from_bits(bits >> shift);
        prop_assert_eq!(i128::from(sum.mean_of(count).bits()), i128::from(sum.bits()).div_euclid(i128::from(count)));
    }

    #[test]
    fn a_difference_of_phases_is_the_shorter_way(a: i32, b: i32) {
        let step = Phase::from_bits(a) - Phase::from_bits(b);
        let exact = (i64::from(a) - i64::from(b) + (1 << 31)).rem_euclid(1 << 32) - (1 << 31);
        prop_assert_eq!(i64::from(step.bits()), exact);
    }

    #[test]
    fn turns_are_whole_turns_and_a_phase(bits in -(1_i64 << 62)..1 << 62) {
        let turns = Turns::from_bits(bits);
        prop_assert_eq!((i64::from(turns.whole_turns()) << 32) + i64::from(turns.phase().bits()), bits);
    }

    #[test]
    fn sums_and_differences_of_turns_are_exact(a in -(1_i64 << 62)..1 << 62, b in -(1_i64 << 62)..1 << 62) {
        let (one, other) = (Turns::from_bits(a), Turns::from_bits(b));
        prop_assert_eq!(((one + other).bits(), (one - other).bits(), (-one).bits()), (a + b, a - b, -a));
        prop_assert_eq!(one.magnitude().bits(), a.abs());
        prop_assert_eq!(one < other, a < b);
    }

    /// Rounding to a unit; a float holds 1000 turns to 1e-12 rad.
    #[test]
    fn rad_and_degrees_become_the_nearest_turns(rad in -6000.0..6000.0_f64) {
        prop_assert!((Turns::from_rad(rad).rad() - rad).abs() <= UNIT / 2.0 + 1e-11);
        prop_assert!(apart(Phase::from_rad(rad).rad(), rad) <= UNIT / 2.0 + 1e-11);
        prop_assert!(apart(Phase::from_degrees(rad.to_degrees()).rad(), rad) <= UNIT / 2.0 + 1e-11);
        prop_assert!(Phase::from_rad(rad).rad().abs() <= PI);
    }

    /// Q loses half a step of 2⁻²⁶ in the remainder and nothing in the turns, however many there are.
    #[test]
    fn an_angle_keeps_its_turns_beside_the_remainder(bits in -(1_i64 << 50)..1 << 50) {
        let turns = Turns::from_bits(bits);
        let (float, fixed) = (Angle::<f64>::from(turns), Angle::<Q>::from(turns));
        prop_assert_eq!((float.whole_turns, fixed.whole_turns), (turns.whole_turns(), turns.whole_turns()));
        prop_assert!((float.remainder - turns.phase().rad()).abs() < 1e-15);
        prop_assert!((fixed.remainder.to_f64() - turns.phase().rad()).abs() < 7.7e-9);
        prop_assert!((float.rad() - turns.rad()).abs() < 1e-15 * turns.rad().abs().max(1.0));
    }
}

#[test]
fn atan2_is_within_two_units_where_its_octants_meet() {
    let lengths = [1, 2, 3, 5, 1000, 1 << 30, 1 << 31, 1 << 33, (1 << 60) + 1, i64::MAX];
    for (a, b) in lengths.iter().flat_map(|a| lengths.iter().map(move |b| (*a, *b))) {
        for (y, x) in [(a, b), (a, -b), (-a, b), (-a, -b), (a, 0), (-a, 0), (0, a), (0, -a), (a, a - 1), (a - 1, a)] {
            assert_atan2(y, x);
        }
    }
    assert_atan2(i64::MIN, i64::MIN);
    assert_atan2(i64::MIN, 1);
    assert_atan2(1, i64::MIN);
}

#[test]
fn atan2_is_within_two_units_about_the_folds_at_an_eighth_of_pi() {
    for eighth in -8..8 {
        for off in [-1e-8, -1e-9, 0.0, 1e-9, 1e-8] {
            let angle = f64::from(eighth) * PI / 8.0 + off;
            assert_atan2((8e18 * angle.sin()) as i64, (8e18 * angle.cos()) as i64);
        }
    }
}

#[test]
fn the_zero_vector_has_no_direction() {
    assert_eq!(Phase::atan2(0, 0), None);
}

#[test]
fn the_axes_are_exact() {
    let quarter = 1 << 30;
    let bits = |y, x| Phase::atan2(y, x).expect("not the zero vector").bits();
    assert_eq!([bits(0, 7), bits(7, 0), bits(-7, 0)], [0, quarter, -quarter]);
    assert_eq!(bits(0, -7), i32::MIN);
}

#[test]
fn a_mean_of_nothing_is_zero() {
    assert_eq!(Turns::from_bits(5).mean_of(0), Turns::ZERO);
}

#[test]
fn the_mean_of_the_longest_sums_is_exact() {
    for bits in [i64::MAX, i64::MIN + 1, i64::MIN] {
        for count in [1, 2, 3, 100, u16::MAX] {
            let exact = i128::from(bits).div_euclid(i128::from(count)) as i64;
            assert_eq!(Turns::from_bits(bits).mean_of(count).bits(), exact, "{bits} / {count}");
        }
    }
}

#[test]
fn the_value_of_an_angle_is_the_whole_angle_until_q_ends() {
    let angle = |turns| Angle { remainder: Q::from_f64(0.25), whole_turns: turns };
    // Half a step of 2⁻²⁶ for 0.25, and four times that of 2π.
    assert!((angle(-4).value().to_f64() - (0.25 - 4.0 * TAU)).abs() < 5.0 * 7.5e-9);
    assert_eq!(angle(6).value(), Q::MAX);
    assert!(angle(-6).value().to_f64() < -31.0);
    let float = Angle { remainder: 0.25, whole_turns: 1000 };
    assert!((float.value() - (0.25 + 1000.0 * TAU)).abs() < 1e-11);
}
