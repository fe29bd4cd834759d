use super::{HeadingGate, HeadingPrediction, Verdict};
use crate::numeric::phase::Turns;

const SECOND: u64 = 1_000_000;
const TICK: u64 = 10_000;

fn degrees(degrees: f64) -> Turns {
    Turns::from_rad(degrees.to_radians())
}

/// A straight segment whose bend sensors do not move.
fn still() -> HeadingPrediction<f64> {
    HeadingPrediction {
        heading: Turns::ZERO,
        motion: 0.0,
        bias: Turns::ZERO,
        theta: 0.0,
        bend: Some(0.0),
        frozen_motion: 8.0_f64.to_radians(),
    }
}

/// A gate that was tared at 0°, at 1 s.
fn tared() -> HeadingGate<f64> {
    let mut gate = HeadingGate::new(0.0);
    gate.tare(Turns::ZERO, Turns::ZERO, SECOND);
    gate
}

/// Takes readings at 100 Hz from a time on, those of a noisy IMU at rest at `heading`.
fn take_for(gate: &mut HeadingGate<f64>, from_us: u64, length_us: u64, heading: f64) -> std::vec::Vec<Verdict<f64>> {
    let at = |k: u64| {
        let noise = if k.is_multiple_of(2) { 0.06 } else { 0.0 };
        gate.check(Some(degrees(heading + noise)), 0, &still(), || None, from_us + k * TICK)
    };
    (0..length_us / TICK).map(at).collect()
}

fn heading_deg(verdict: Verdict<f64>) -> f64 {
    match verdict {
        Verdict::Accepted(heading) | Verdict::Returned(heading) => heading.rad().to_degrees(),
        other => panic!("{other:?} is no heading"),
    }
}

extern crate std;

#[test]
fn a_jump_of_50_ms_is_not_used() {
    let mut gate = tared();
    assert!(take_for(&mut gate, SECOND, 50_000, 30.0).iter().all(|verdict| *verdict == Verdict::Absent));
}

#[test]
fn a_jump_of_50_ms_leaves_nothing() {
    let mut gate = tared();
    take_for(&mut gate, SECOND, 50_000, 30.0);
    let after = take_for(&mut gate, SECOND + 50_000, SECOND, 0.0);
    assert!(after.iter().all(|verdict| matches!(verdict, Verdict::Accepted(_))), "{after:?}");
    assert!(after.iter().all(|verdict| heading_deg(*verdict).abs() < 0.1));
}

#[test]
fn a_jump_that_stays_becomes_a_new_zero_after_0_4_s() {
    let mut gate = tared();
    let verdicts = take_for(&mut gate, SECOND, SECOND, 30.0);
    let restart = verdicts.iter().position(|verdict| matches!(verdict, Verdict::Restarted(..))).expect("it restarts");
    assert!((35..=40).contains(&restart), "after {restart} samples");
    let Verdict::Restarted(deviation, absence_us) = verdicts[restart] else { panic!("it restarts") };
    assert!((deviation.rad().to_degrees() - 30.0).abs() < 0.1 && absence_us < SECOND / 2);
}

#[test]
fn two_wild_readings_with_a_good_one_between_them_are_not_a_new_zero() {
    let mut gate = tared();
    for (time_us, heading) in [(0, 30.0), (SECOND / 5, 0.0), (SECOND, 30.0)] {
        let verdict = gate.check(Some(degrees(heading)), 0, &still(), || None, SECOND + time_us);
        assert!(matches!(verdict, Verdict::Absent | Verdict::Accepted(_)), "{verdict:?}");
    }
}

#[test]
fn two_wild_readings_seconds_apart_are_not_a_new_zero() {
    let mut gate = tared();
    for time_us in [2 * SECOND, 7 * SECOND] {
        assert_eq!(gate.check(Some(degrees(30.0)), 0, &still(), || None, time_us), Verdict::Absent);
        assert_eq!(gate.check(None, 0, &still(), || None, time_us + TICK), Verdict::Absent);
    }
}

#[test]
fn a_jump_is_confirmed_although_every_third_reading_is_missing() {
    let mut gate = tared();
    let at =
        |k: u64| gate.check((!k.is_multiple_of(3)).then(|| degrees(30.0)), 0, &still(), || None, SECOND + k * TICK);
    assert!((0..50).map(at).any(|verdict| matches!(verdict, Verdict::Restarted(..))));
}

#[test]
fn an_absolute_heading_that_is_read_late_keeps_its_zero() {
    let mut gate = HeadingGate::new(0.0);
    gate.expect_absolute();
    let verdict = gate.check(Some(degrees(77.0)), 0, &still(), || None, 5 * SECOND);
    assert!((heading_deg(verdict) - 77.0).abs() < 1e-6);
}

#[test]
fn an_imu_that_returns_after_a_gap_near_its_old_zero_is_used_at_once() {
    let mut gate = tared();
    let verdict = gate.check(Some(degrees(3.0)), 0, &still(), || None, 11 * SECOND);
    assert!(matches!(verdict, Verdict::Returned(_)), "{verdict:?}");
    assert!((heading_deg(verdict) - 3.0).abs() < 1e-6);
}

#[test]
fn an_imu_that_returns_after_a_gap_with_another_zero_restarts() {
    let mut gate = tared();
    let verdicts = take_for(&mut gate, 11 * SECOND, SECOND, -120.0);
    let restart = verdicts.iter().find(|verdict| matches!(verdict, Verdict::Restarted(..))).expect("it restarts");
    let Verdict::Restarted(deviation, absence_us) = *restart else { panic!("it restarts") };
    assert!((deviation.rad().to_degrees() + 120.0).abs() < 0.1 && absence_us > 10 * SECOND);
}

#[test]
fn an_imu_that_was_not_read_in_the_tare_starts_where_the_bend_sensors_are() {
    let mut gate = HeadingGate::new(0.0);
    let expected = HeadingPrediction { heading: degrees(20.0), ..still() };
    let first = gate.check(Some(degrees(77.0)), 0, &expected, || None, SECOND);
    assert!(matches!(first, Verdict::Restarted(deviation, _) if deviation == Turns::ZERO), "{first:?}");
    let next = gate.check(Some(degrees(78.0)), 0, &expected, || None, SECOND + TICK);
    assert!((heading_deg(next) - 21.0).abs() < 1e-6);
}

#[test]
fn a_heading_that_passes_360_degrees_does_not_step() {
    let mut gate = tared();
    let mut before = 0.0;
    // 100 °/s for 8 s, which the bend sensors follow: the prediction is the last heading.
    for k in 1..800_u32 {
        let turned = f64::from(k);
        let expected = HeadingPrediction { heading: degrees(before), motion: 1.0_f64.to_radians(), ..still() };
        before = heading_deg(gate.check(Some(degrees(turned)), 0, &expected, || None, SECOND + u64::from(k) * TICK));
        assert!((before - turned).abs() < 1e-5, "{before} instead of {turned}");
    }
}

#[test]
fn fast_motion_that_the_bend_sensors_see_is_no_jump() {
    let mut gate = tared();
    let moved = HeadingPrediction { heading: degrees(20.0), motion: 20.0_f64.to_radians(), ..still() };
    assert!((heading_deg(gate.check(Some(degrees(45.0)), 0, &moved, || None, SECOND + TICK)) - 45.0).abs() < 1e-6);
}

#[test]
fn a_step_of_the_bend_sensors_is_no_jump_of_the_imu() {
    let mut gate = tared();
    let stepped = HeadingPrediction { heading: degrees(30.0), motion: 30.0_f64.to_radians(), ..still() };
    assert!(heading_deg(gate.check(Some(degrees(0.5)), 0, &stepped, || None, SECOND + TICK)).abs() < 1.0);
}

#[test]
fn the_gyroscope_s_sensitivity_is_corrected() {
    let mut gate = tared();
    let scale_error = (0.02 * 4_294_967_296.0) as i32;
    let mut heading = 0.0;
    for k in 1..=90_u32 {
        let expected = HeadingPrediction { heading: degrees(heading), ..still() };
        let reading = Some(degrees(f64::from(k) * 1.02));
        heading = heading_deg(gate.check(reading, scale_error, &expected, || None, SECOND + u64::from(k) * TICK));
    }
    // 1.02 · (1 − 0.02) is 1 − 0.0004.
    assert!((heading - 90.0 * 0.9996).abs() < 1e-4, "{heading}");
}

/// Bend sensors that turn by 20 °/s while the IMU's output is 5° to the bit.
fn frozen(gate: &mut HeadingGate<f64>, from: u64, to: u64) -> std::vec::Vec<Verdict<f64>> {
    let at = |k: u64| {
        let bend = (k as f64 * 0.2).to_radians();
        let expected = HeadingPrediction { heading: Turns::from_rad(bend), theta: bend, bend: Some(bend), ..still() };
        gate.check(Some(Turns::ZERO), 0, &expected, || None, SECOND + k * TICK)
    };
    (from..to).map(at).collect()
}

#[test]
fn output_that_is_frozen_while_the_bend_sensors_move_is_not_used() {
    let verdicts = frozen(&mut tared(), 0, 300);
    assert!(!verdicts[..95].iter().any(|verdict| matches!(verdict, Verdict::Frozen(_))));
    let Verdict::Frozen(theta) = verdicts[250] else { panic!("{:?}", verdicts[250]) };
    assert!((theta.to_degrees() - 50.0).abs() < 0.3, "{}", theta.to_degrees());
}

#[test]
fn an_imu_stays_frozen_while_its_bend_sensors_are_missing() {
    let mut gate = tared();
    frozen(&mut gate, 0, 200);
    let expected = HeadingPrediction { heading: degrees(40.0), theta: 0.7, bend: None, ..still() };
    assert_eq!(gate.check(Some(Turns::ZERO), 0, &expected, || None, 3 * SECOND), Verdict::Frozen(0.7));
}

#[test]
fn bend_sensors_that_return_elsewhere_do_not_freeze_an_imu_at_rest() {
    let mut gate = tared();
    let without = HeadingPrediction { bend: None, ..still() };
    gate.check(Some(degrees(1.0)), 0, &without, || None, SECOND);
    let elsewhere = HeadingPrediction { bend: Some(0.5), ..still() };
    for k in 0..300 {
        let verdict = gate.check(Some(degrees(1.0)), 0, &elsewhere, || None, SECOND + k * TICK);
        assert!(matches!(verdict, Verdict::Accepted(_)), "{verdict:?} at sample {k}");
    }
}

#[test]
fn an_arm_at_rest_does_not_freeze_its_imu() {
    let mut gate = tared();
    for k in 0..500 {
        let verdict = gate.check(Some(Turns::ZERO), 0, &still(), || None, SECOND + k * TICK);
        assert!(matches!(verdict, Verdict::Accepted(_)), "{verdict:?} at sample {k}");
    }
}

#[test]
fn a_reading_that_was_late_while_the_segment_moved_is_no_new_zero() {
    let mut gate = tared();
    // The segment bends by 60° a second; the output stands still for 0.5 s, and θ follows it.
    let at = |k: u64| 60.0 * (k as f64 * 0.01);
    let check = |gate: &mut HeadingGate<f64>, k: u64, read: f64, last: f64| {
        let (motion, bend) = (0.6_f64.to_radians(), Some(at(k).to_radians()));
        let theta = last.to_radians();
        let expected = HeadingPrediction { heading: degrees(last + 0.6), motion, theta, bend, ..still() };
        gate.check(Some(degrees(read)), 0, &expected, || None, SECOND + k * TICK)
    };
    let mut last = 0.0;
    for k in 1..=120 {
        let read = if (50..100).contains(&k) { at(49) } else { at(k) };
        let verdict = check(&mut gate, k, read, last);
        assert!(matches!(verdict, Verdict::Accepted(_)), "{verdict:?} in sample {k}");
        last = heading_deg(verdict);
    }
    assert!((last - at(120)).abs() < 0.1, "{last} degrees");
}
