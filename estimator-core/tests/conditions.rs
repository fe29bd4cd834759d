//! Conditions of sensors that the bias filter reports, and disturbances that must not affect it.

mod common;

use common::{Arm, N, config, counts, segments, turned};
use estimator_core::{Conditions, Estimator, ImuReading, Phase, Q, Sample};

/// Errors of the bend angles and conditions in the last sample of a run.
struct Run {
    /// Largest error of a bend angle in the last minute, degrees.
    worst_deg: f64,
    /// Largest scaled variance of a bend angle in the last sample.
    variance: f64,
    conditions: Conditions<N>,
}

/// Runs an arm at its rate; `edit` changes sample `k` before the estimator gets it.
fn run(mut arm: Arm, seconds: f64, mut edit: impl FnMut(u64, &mut Sample<N>)) -> Run {
    let segments = segments();
    let config = config(&segments, arm.rate_hz);
    let mut estimator = Estimator::<Q, N, 100>::new(&config).expect("a valid configuration");
    let mut worst_deg = 0.0_f64;
    for k in 0..(seconds * arm.rate_hz) as u64 {
        let mut sample = arm.sample(k);
        edit(k, &mut sample);
        let estimate = estimator.update_full(&sample);
        if arm.seconds(k) >= seconds - 60.0 {
            for (segment, truth) in estimate.segments.iter().zip(arm.theta(arm.seconds(k))) {
                let theta = segment.fusion.expect("it is known").theta.rad().to_degrees();
                worst_deg = worst_deg.max((theta - truth).abs());
            }
        }
    }
    let variances = estimator.uncertainties();
    let variance = variances.iter().filter_map(|of| of.theta).map(Q::to_f64).fold(0.0, f64::max);
    Run { worst_deg, variance, conditions: estimator.conditions() }
}

#[test]
fn a_motion_of_over_twenty_degrees_in_a_sample_is_no_new_zero() {
    // 40 · 2π / 1 s: 25° from one sample to the next.
    let arm = Arm { amplitude: [40.0, 35.0, 30.0], period: [1.0, 1.1, 1.3], ..Arm::default() };
    let run = run(arm, 120.0, |_, _| {});
    assert!(run.worst_deg < 3.0, "{} degrees", run.worst_deg);
    assert!(run.conditions.iter().all(|condition| !condition.imu_restarted), "{:?}", run.conditions);
}

#[test]
fn an_imu_that_restarts_in_the_tare_has_its_zero_from_there_and_is_reported() {
    let edit = |k: u64, sample: &mut Sample<N>| match k {
        3..6 => sample.imu[1] = None,
        6.. => sample.imu[1] = turned(sample.imu[1], 130.0),
        _ => {}
    };
    let soon = run(Arm::default(), 30.0, edit);
    assert!(soon.conditions[1].imu_restarted && !soon.conditions[1].tare_bad, "{:?}", soon.conditions);
    let later = run(Arm::default(), 120.0, edit);
    assert!(later.worst_deg < 3.0, "{} degrees", later.worst_deg);
}

#[test]
fn a_segment_that_rests_while_others_move_stays_where_its_bend_sensors_are() {
    // Without an update the first IMU's drift is 45° at the end.
    let arm = Arm { amplitude: [0.0, 30.0, 35.0], drift: [0.05; N], map_error: 0.0, ..Arm::default() };
    let run = run(arm, 900.0, |_, _| {});
    assert!(run.worst_deg < 4.0, "{} degrees", run.worst_deg);
}

#[test]
fn a_segment_without_any_bend_sensor_that_reads_is_reported() {
    let run = run(Arm::default(), 60.0, |k, sample| {
        if k >= 300 {
            sample.bend[2] = [None; 2];
        }
    });
    let reported: Vec<bool> = run.conditions.iter().map(|condition| condition.bend_distrusted).collect();
    assert_eq!(reported, [false, false, true]);
}

#[test]
fn a_bend_sensor_that_breaks_away_is_named_within_a_second_and_for_a_minute() {
    let broken = |k: u64, sample: &mut Sample<N>| {
        if k >= 300 {
            sample.bend[1][1] = Some(counts(70.0));
        }
    };
    for seconds in [31.0, 60.0] {
        let run = run(Arm::default(), seconds, broken);
        let named: Vec<_> = run.conditions.iter().map(|condition| condition.bend_implausible).collect();
        assert_eq!(named, [[false; 2], [false, true], [false; 2]], "after {seconds} s");
    }
}

#[test]
fn a_bend_sensor_whose_counts_are_outside_its_calibration_is_named() {
    let run = run(Arm::default(), 31.0, |k, sample| {
        if k >= 300 {
            sample.bend[2][0] = Some(4000);
        }
    });
    let named: Vec<_> = run.conditions.iter().map(|condition| condition.bend_implausible).collect();
    assert_eq!(named, [[false; 2], [false; 2], [true, false]]);
}

#[test]
fn an_imu_that_jumps_is_implausible_until_it_has_a_new_zero() {
    let jumped = |k: u64, sample: &mut Sample<N>| {
        if k >= 300 {
            sample.imu[1] = Some(ImuReading::Heading(Phase::from_degrees(123.0)));
        }
    };
    let at = |seconds: f64| run(Arm::default(), seconds, jumped).conditions[1];
    assert!(!at(29.9).imu_implausible);
    assert!(at(30.1).imu_implausible && at(30.1).imu_absent);
}

#[test]
fn an_imu_that_was_absent_for_a_second_may_have_a_new_zero_for_a_minute() {
    let absent = |k: u64, sample: &mut Sample<N>| {
        if (300..310).contains(&k) {
            sample.imu[0] = None;
        }
    };
    let soon = run(Arm::default(), 80.0, absent);
    assert!(soon.conditions[0].imu_restarted && !soon.conditions[1].imu_restarted, "{:?}", soon.conditions);
    let later = run(Arm::default(), 100.0, absent);
    assert!(!later.conditions[0].imu_restarted, "{:?}", later.conditions);
}

#[test]
fn bend_sensors_that_read_off_in_the_tare_are_trusted_less() {
    let variance = |bend_offset| run(Arm { bend_offset, ..Arm::default() }, 300.0, |_, _| {}).variance;
    let (straight, off) = (variance([0.0; N]), variance([3.0, -3.0, 3.0]));
    assert!(off > 2.0 * straight, "{off} and {straight}");
}
