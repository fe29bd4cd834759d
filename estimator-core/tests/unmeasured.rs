//! Segments that lose sensors: all of their own, or an IMU while the tare ends.

mod common;

use common::{Arm, N, config, segments, turned};
use estimator_core::{Estimator, Q, Sample, VARIANCE_SCALE};

/// Bend angles in degrees, whether the tip is known, and the deviations of the bend angles in degrees, sample after sample.
struct Run {
    theta_deg: Vec<[Option<f64>; N]>,
    is_tip_known: Vec<bool>,
    deviation_deg: Vec<[Option<f64>; N]>,
}

impl Run {
    /// Errors of the angle of segment `i` in degrees, from a sample on, with the numbers of the samples.
    fn errors_deg(&self, i: usize, from: usize) -> impl Iterator<Item = (usize, f64)> {
        let arm = Arm::default();
        let known = self.theta_deg.iter().enumerate().skip(from);
        known.map(move |(k, theta)| (k, theta[i].expect("it is known") - arm.theta(arm.seconds(k as u64))[i]))
    }

    /// Checks that the angle of segment `i` is known and near the true one from a sample on.
    fn assert_near(&self, i: usize, from: usize, limit_deg: f64) {
        for (k, error) in self.errors_deg(i, from) {
            assert!(error.abs() < limit_deg, "{error} degrees in sample {k}");
        }
    }
}

fn run(seconds: f64, mut edit: impl FnMut(u64, &mut Sample<N>)) -> Run {
    let mut arm = Arm::default();
    let segments = segments();
    let config = config(&segments, arm.rate_hz);
    let mut estimator = Estimator::<Q, N, 100>::new(&config).expect("a valid configuration");
    let mut run = Run { theta_deg: Vec::new(), is_tip_known: Vec::new(), deviation_deg: Vec::new() };
    for k in 0..(seconds * arm.rate_hz) as u64 {
        let mut sample = arm.sample(k);
        edit(k, &mut sample);
        let shape = estimator.update(&sample);
        run.theta_deg.push(std::array::from_fn(|i| shape[i].theta.map(|theta| theta.rad().to_degrees())));
        run.is_tip_known.push(shape[N - 1].end.is_some());
        let uncertainties = estimator.uncertainties();
        run.deviation_deg.push(std::array::from_fn(|i| {
            uncertainties[i].theta.map(|scaled| (scaled.to_f64() / VARIANCE_SCALE).sqrt().to_degrees())
        }));
    }
    run
}

/// Takes all sensors of segment `i` away from 30 s on, until sample `until`.
fn without(i: usize, until: u64) -> impl FnMut(u64, &mut Sample<N>) {
    move |k, sample| {
        if (300..until).contains(&k) {
            (sample.imu[i], sample.bend[i]) = (None, [None; 2]);
        }
    }
}

#[test]
fn the_last_segment_is_not_known_half_a_second_after_its_sensors() {
    let run = run(40.0, without(2, 1000));
    assert!(run.theta_deg[..304].iter().all(|theta| theta[2].is_some()));
    assert!(run.theta_deg[305..].iter().all(|theta| theta[0].is_some() && theta[1].is_some() && theta[2].is_none()));
    assert!(run.is_tip_known[..304].iter().all(|is_known| *is_known));
    assert!(run.is_tip_known[305..].iter().all(|is_known| !is_known));
}

#[test]
fn until_then_its_angle_is_doubted() {
    let run = run(31.0, without(2, 1000));
    let of = |k: usize| run.deviation_deg[k][2].expect("it is known");
    assert!(of(299) < 3.0 && of(303) > 6.0, "{} and {} degrees", of(299), of(303));
}

#[test]
fn a_segment_below_others_follows_from_their_sensors() {
    let run = run(90.0, without(1, 1000));
    run.assert_near(1, 300, 4.0);
    for (k, error) in run.errors_deg(1, 300) {
        let deviation = run.deviation_deg[k][1].expect("it is known");
        assert!(error.abs() < 4.0 * deviation, "{error} of {deviation} degrees in sample {k}");
    }
}

#[test]
fn a_segment_whose_sensors_return_is_known_again() {
    run(90.0, without(2, 400)).assert_near(2, 400, 6.0);
}

#[test]
fn estimates_do_not_change_where_microseconds_pass_32_bits() {
    let arm_starts_at_us = 100_000_000;
    let early = run(120.0, |_, _| {});
    let late = run(120.0, |_, sample| sample.time_us += (1 << 32) - 60_000_000 - arm_starts_at_us);
    assert_eq!(early.theta_deg, late.theta_deg);
}

#[test]
fn a_bend_sensor_that_was_left_out_stays_so_while_its_imu_is_absent() {
    let run = run(90.0, |k, sample| {
        if (300..310).contains(&k) {
            sample.bend[1][0] = sample.bend[1][0].map(|counts| counts + 400);
        }
        if k >= 305 {
            sample.imu[1] = None;
        }
    });
    run.assert_near(1, 300, 6.0);
}

#[test]
fn an_imu_that_restarts_across_the_end_of_the_tare_has_its_new_zero() {
    let run = run(90.0, |k, sample| {
        if (3..10).contains(&k) {
            sample.imu[1] = None;
        } else if k >= 10 {
            sample.imu[1] = turned(sample.imu[1], 100.0);
        }
    });
    run.assert_near(1, 20, 6.0);
}
