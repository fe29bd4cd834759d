//! One IMU: from quaternions to headings, unwrapped and tared.

use std::f64::consts::{PI, TAU};

use estimator_core::{FusedOps, HeadingTracker, ImuReading, Phase, Q, Turns};
use proptest::prelude::*;

/// One unit of 2⁻³² turns, rad.
const UNIT: f64 = TAU / 4_294_967_296.0;
const ONE: f64 = 1_073_741_824.0;

fn apart(one: f64, other: f64) -> f64 {
    let turns = (one - other) / TAU;
    ((turns - turns.round()) * TAU).abs()
}

/// h = −atan2(2(wz + xy), 1 − 2(y² + z²)) of the very numbers that were read.
fn formula(quaternion: [i32; 4]) -> f64 {
    let [w, x, y, z] = quaternion.map(|part| f64::from(part) / ONE);
    -f64::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

/// Quaternions of this norm in units of 2⁻³⁰, of any direction.
fn quaternion(norm: f64) -> impl Strategy<Value = [i32; 4]> {
    prop::array::uniform4(-1.0..1.0_f64).prop_filter_map("has a direction", move |parts| {
        let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        (length > 0.1).then(|| parts.map(|part| (part / length * norm * ONE).round() as i32))
    })
}

fn heading(quaternion: [i32; 4]) -> Option<Phase> {
    ImuReading::Quaternion(quaternion).heading()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    /// Products are exact, so the error is that of atan2: two units. Floats themselves lose digits where the sensor's x
    /// axis points almost straight up, so that is left out.
    #[test]
    fn the_heading_of_a_quaternion_is_the_formula(parts in quaternion(1.0)) {
        let [w, x, y, z] = parts.map(|part| f64::from(part) / ONE);
        prop_assume!((w * z + x * y).hypot(0.5 - y * y - z * z) > 1e-4);
        let error = apart(heading(parts).expect("a unit quaternion").rad(), formula(parts));
        prop_assert!(error <= 2.0 * UNIT, "{} rad", error);
    }

    /// One is the other's negative, so the products are the same.
    #[test]
    fn a_quaternion_and_its_negative_have_the_same_heading(parts in quaternion(1.0)) {
        prop_assert_eq!(heading(parts), heading(parts.map(|part| -part)));
    }

    #[test]
    fn a_norm_within_a_half_percent_is_accepted(parts in prop_oneof![quaternion(0.995), quaternion(1.005)]) {
        prop_assert!(heading(parts).is_some());
    }

    #[test]
    fn a_norm_beyond_two_percent_is_rejected(
        parts in prop_oneof![quaternion(0.0), quaternion(0.5), quaternion(0.98), quaternion(1.02), quaternion(1.9)]
    ) {
        prop_assert_eq!(heading(parts), None);
    }

    #[test]
    fn any_registers_give_a_heading_or_none(registers: [i16; 4], parts: [i32; 4]) {
        let norm = registers.map(|part| f64::from(part) / 16384.0).iter().map(|part| part * part).sum::<f64>().sqrt();
        prop_assume!((norm - 1.0).abs() > 0.011);
        prop_assert_eq!(ImuReading::from_bno055(registers).heading(), None);
        let _ = heading(parts);
    }

    /// Yaw alone: the heading is that of the registers, to the quantisation of 2⁻¹⁴ (a half over the shorter
    /// of two parts' derivative: 2⁻¹⁴ rad each).
    #[test]
    fn registers_of_a_bno055_are_turned_clockwise(yaw in -PI..PI) {
        let part = |value: f64| (value * 16384.0).round() as i16;
        let reading = ImuReading::from_bno055([part((yaw / 2.0).cos()), 0, 0, part((yaw / 2.0).sin())]);
        let error = apart(reading.heading().expect("a unit quaternion").rad(), -yaw);
        prop_assert!(error <= 2.0 / 16384.0, "{} rad", error);
    }

    /// However often and however far the phase wraps, the output moves by exactly what the sensor moved.
    #[test]
    fn wraps_never_step_the_unwrapped_heading(start: i32, steps in prop::collection::vec(-i32::MAX..i32::MAX, 1..200)) {
        let mut imu = HeadingTracker::<Q>::new(0, Turns::ZERO);
        let mut phase = start;
        let mut expected = imu.read(Some(Phase::from_bits(phase))).expect("it was read");
        prop_assert_eq!(expected.bits(), i64::from(start));
        for step in steps {
            phase = phase.wrapping_add(step);
            expected = expected + Turns::from_bits(i64::from(step));
            prop_assert_eq!(imu.read(Some(Phase::from_bits(phase))), Some(expected));
        }
    }

    /// The mean of sines and cosines in floats. Float arcs err by 2e-10, atan2 by two units; readings within a radian
    /// of each other keep the mean vector longer than ½, which doubles the error of its parts.
    #[test]
    fn a_float_tare_is_the_circular_mean(around in -PI..PI, off in prop::collection::vec(-0.5..0.5, 1..50)) {
        prop_assert!(tare_error::<f64>(around, &off) <= 2.0 * UNIT + UNIT / 2.0 + 4e-10);
    }

    /// A fixed-point sine is within four steps of 2⁻²⁶.
    #[test]
    fn a_fixed_point_tare_is_the_circular_mean(around in -PI..PI, off in prop::collection::vec(-0.5..0.5, 1..50)) {
        prop_assert!(tare_error::<Q>(around, &off) <= 4.0 / 67_108_864.0);
    }
}

/// Deviation of the tare from the circular mean of readings at these distances from a direction, rad.
fn tare_error<S: FusedOps>(around: f64, off: &[f64]) -> f64 {
    let mut imu = HeadingTracker::<S>::new(off.len() as u32, Turns::ZERO);
    let readings: Vec<_> = off.iter().map(|off| around + off).collect();
    for reading in &readings {
        imu.read(Some(Phase::from_rad(*reading)));
    }
    let (sin, cos) = readings.iter().fold((0.0, 0.0), |(s, c), reading| (s + reading.sin(), c + reading.cos()));
    let zero = imu.zero().expect("the tare is complete");
    apart(zero.rad(), sin.atan2(cos))
}

fn read_degrees(imu: &mut HeadingTracker<Q>, degrees: f64) -> f64 {
    imu.read(Some(Phase::from_degrees(degrees))).expect("it was read").rad().to_degrees()
}

#[test]
fn a_zero_quaternion_after_a_brown_out_is_rejected() {
    assert_eq!(ImuReading::from_bno055([0; 4]).heading(), None);
}

#[test]
fn overflowed_registers_are_rejected() {
    for extreme in [i32::MIN, i32::MAX] {
        assert_eq!(heading([extreme; 4]), None);
        assert_eq!(heading([extreme, 0, 0, 0]), None);
    }
    assert_eq!(ImuReading::from_bno055([i16::MIN; 4]).heading(), None);
}

#[test]
fn an_x_axis_straight_up_has_no_heading() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let part = (half * ONE) as i32;
    // The parts' squares cannot be exactly ½, so the nearest that can: w z + x y = 0 and y² + z² = ½.
    assert_eq!(heading([1 << 29, 1 << 29, -(1 << 29), 1 << 29]), None);
    assert!(heading([part, 0, 0, part]).is_some());
}

/// 10⁶ readings of 0.3 turns: 300 000 turns of drift, of which no unit is lost.
#[test]
fn drift_far_past_360_degrees_stays_exact() {
    const STEP: i64 = 1_288_490_189;
    let mut imu = HeadingTracker::<Q>::new(0, Turns::ZERO);
    for count in 0..1_000_000_i64 {
        let exact = count * STEP;
        let unwrapped = imu.read(Some(Phase::from_bits(exact as i32)));
        assert_eq!(unwrapped, Some(Turns::from_bits(exact)));
    }
}

#[test]
fn a_missing_reading_leaves_the_turns_as_they_were() {
    let mut imu = HeadingTracker::<Q>::new(0, Turns::ZERO);
    read_degrees(&mut imu, 170.0);
    read_degrees(&mut imu, 190.0);
    assert_eq!(imu.read(None), None);
    assert!((read_degrees(&mut imu, 200.0) - 200.0).abs() < 1e-6);
}

#[test]
fn an_absolute_heading_is_wrapped_to_half_a_turn_at_the_start_alone() {
    let mut imu = HeadingTracker::<Q>::new(0, Turns::ZERO);
    assert!((read_degrees(&mut imu, 350.0) + 10.0).abs() < 1e-6);
    assert_eq!(imu.zero(), Some(Turns::ZERO));
    for degrees in [270.0, 190.0, 110.0, 30.0] {
        read_degrees(&mut imu, degrees);
    }
    assert!((read_degrees(&mut imu, 310.0) + 410.0).abs() < 1e-6);
}

#[test]
fn a_tare_across_the_seam_at_180_degrees_is_there_and_not_at_0() {
    let mut imu = HeadingTracker::<Q>::new(4, Turns::ZERO);
    let unwrapped = [179.0, -179.0, 178.0, -178.0].map(|degrees| read_degrees(&mut imu, degrees));
    let zero = imu.zero().expect("the tare is complete").rad().to_degrees();
    assert!((zero - 180.0).abs() < 1e-5);
    for (heading, expected) in unwrapped.iter().zip([-1.0, 1.0, -2.0, 2.0]) {
        assert!((heading - zero - expected).abs() < 1e-5);
    }
}

#[test]
fn the_zero_is_unknown_until_the_last_sample_of_the_tare() {
    let mut imu = HeadingTracker::<Q>::new(3, Turns::ZERO);
    for _ in 0..2 {
        read_degrees(&mut imu, 10.0);
        assert_eq!(imu.zero(), None);
    }
    read_degrees(&mut imu, 10.0);
    assert!((imu.zero().expect("the tare is complete").rad().to_degrees() - 10.0).abs() < 1e-5);
    read_degrees(&mut imu, 40.0);
    assert!((imu.zero().expect("the tare is complete").rad().to_degrees() - 10.0).abs() < 1e-5);
}

#[test]
fn a_missing_reading_takes_its_place_in_the_tare() {
    let mut imu = HeadingTracker::<Q>::new(3, Turns::ZERO);
    imu.read(None);
    read_degrees(&mut imu, 10.0);
    assert_eq!(imu.zero(), None);
    imu.read(None);
    assert!((imu.zero().expect("the tare is complete").rad().to_degrees() - 10.0).abs() < 1e-5);
}

#[test]
fn an_imu_that_was_not_read_during_the_tare_has_no_zero() {
    let mut imu = HeadingTracker::<Q>::new(2, Turns::ZERO);
    imu.read(None);
    imu.read(None);
    read_degrees(&mut imu, 10.0);
    assert_eq!(imu.zero(), None);
}

#[test]
fn the_tare_is_the_heading_of_the_reference_pose() {
    let mut imu = HeadingTracker::<Q>::new(1, Turns::from_rad(0.5));
    let heading = imu.read(Some(Phase::from_rad(2.0))).expect("it was read");
    let zero = imu.zero().expect("the tare is complete");
    assert!(((heading - zero).rad() - 0.5).abs() <= 4.0 / 67_108_864.0);
}
