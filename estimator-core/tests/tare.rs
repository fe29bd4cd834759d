//! A bend sensor that is wrong when the arm is tared: its twin alone is used, and the other is named.

mod common;

use common::{Arm, N, config, segments};
use estimator_core::{Condition, Estimator, Q, Sample};

/// 32° of the arm's sensors, half of which would bend the segment.
const WRONG_COUNTS: u16 = 700;
const SAMPLES: u64 = 600;

/// Worst error of the second segment's angle from 3 s on, degrees, and its condition after every sample.
fn run(arm: &Arm, mut edit: impl FnMut(u64, &mut Sample<N>)) -> (f64, Vec<Condition>) {
    let mut arm = arm.clone();
    let segments = segments();
    let config = config(&segments, arm.rate_hz);
    let mut estimator = Estimator::<Q, N, 100>::new(&config).expect("a valid configuration");
    let (mut worst, mut conditions): (f64, _) = (0.0, Vec::new());
    for k in 0..SAMPLES {
        let mut sample = arm.sample(k);
        edit(k, &mut sample);
        let theta = estimator.update(&sample)[1].theta;
        if k > 30 {
            let theta = theta.expect("it is known").rad().to_degrees();
            worst = worst.max((theta - arm.theta(arm.seconds(k))[1]).abs());
        }
        conditions.push(estimator.conditions()[1]);
    }
    (worst, conditions)
}

/// Makes the first bend sensor of the second segment wrong from a sample on.
fn wrong_from(first: u64) -> impl FnMut(u64, &mut Sample<N>) {
    move |k, sample| {
        if let (true, Some(counts)) = (k >= first, &mut sample.bend[1][0]) {
            *counts += WRONG_COUNTS;
        }
    }
}

/// Checks that a bend sensor that is wrong from a sample on, before the end of the tare, is left out and named.
fn assert_left_out(first: u64) {
    let (clean, _) = run(&Arm::default(), |_, _| {});
    let (worst, conditions) = run(&Arm::default(), wrong_from(first));
    assert!(worst < 1.5 * clean + 1.0, "{worst} degrees, {clean} without the fault");
    for condition in &conditions[10..] {
        assert!(condition.bend_implausible == [true, false] && !condition.tare_bad, "{condition:?}");
    }
}

#[test]
fn a_bend_sensor_that_was_wrong_before_the_tare_is_left_out_and_named() {
    assert_left_out(0);
}

#[test]
fn a_bend_sensor_that_becomes_wrong_in_the_tare_is_left_out_and_named() {
    assert_left_out(5);
}

#[test]
fn a_bend_sensor_that_reads_nothing_until_after_the_tare_is_left_out_where_it_is_wrong() {
    let (clean, _) = run(&Arm::default(), |_, _| {});
    let mut wrong = wrong_from(0);
    let (worst, conditions) = run(&Arm::default(), |k, sample| {
        wrong(k, sample);
        if k < 40 {
            sample.bend[1][0] = None;
        }
    });
    assert!(worst < 1.5 * clean + 1.0, "{worst} degrees, {clean} without the fault");
    assert!(conditions[45..].iter().all(|condition| condition.bend_implausible == [true, false]));
}

#[test]
fn twins_that_agree_on_a_bent_arm_are_both_kept() {
    let bent = Arm { rest: [0.0, 25.0, 0.0], ..Arm::default() };
    let (_, conditions) = run(&bent, |_, _| {});
    assert!(conditions.iter().all(|condition| condition.bend_implausible == [false; 2]));
    assert!(conditions[SAMPLES as usize - 1].tare_bad);
}
