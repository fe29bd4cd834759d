//! The whole estimator with the bias filter, on a small simulated arm.

mod common;

use common::{Arm, N, config, counts, segments};
use estimator_core::{ArmConfig, Estimate, Estimator, ImuReading, Method, Phase, Q, Sample, SegmentConfig};

/// A drift of 0.05 °/s on each IMU, one of them backwards, and bend sensors that are off.
fn drifting() -> Arm {
    Arm { drift: [0.05, -0.05, 0.05], bend_offset: [2.0, -1.5, 1.5], ..Arm::default() }
}

/// Errors of one run, degrees.
#[derive(Debug, Default)]
struct Errors {
    /// Of each segment's angle in the last minute, largest.
    theta: [f64; N],
    /// Of each segment's angle in the last minute, mean.
    mean: [f64; N],
    /// Of the tip in the last minute, root mean square, mm.
    tip_mm: f64,
    /// Share of the samples whose tip is within the 95 % ellipse.
    within_ellipse: f64,
    /// Deviation of the tip in the last sample by its covariance, mm.
    tip_deviation_mm: f64,
}

/// World point of the tip at these bend angles, m.
fn tip(theta: [f64; N]) -> [f64; 2] {
    let (mut heading, mut x, mut y) = (0.0_f64, 0.0, 0.0);
    for theta in theta.map(f64::to_radians) {
        let theta = if theta.abs() < 1e-6 { 1e-6 } else { theta };
        let px = 0.080 * (1.0 - theta.cos()) / theta + 0.017 * theta.sin();
        let py = 0.080 * theta.sin() / theta + 0.017 * theta.cos();
        x += px * heading.cos() + py * heading.sin();
        y += -px * heading.sin() + py * heading.cos();
        heading += theta;
    }
    [x, y]
}

fn fused(estimate: &Estimate<Q, N>) -> [f64; N] {
    core::array::from_fn(|i| estimate.segments[i].fusion.map_or(f64::NAN, |link| link.theta.rad().to_degrees()))
}

/// Returns `true` if the tip's error is within the 95 % ellipse of its covariance.
fn is_within_ellipse([xx, xy, yy]: [f64; 3], [dx, dy]: [f64; 2]) -> bool {
    (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy) < 5.99
}

/// Runs an arm for so long; `edit` changes each sample before the estimator gets it.
fn run(config: &ArmConfig<Q>, arm: &mut Arm, seconds: f64, mut edit: impl FnMut(f64, &mut Sample<N>)) -> Errors {
    let mut estimator = Estimator::<Q, N, 100>::new(config).expect("a valid configuration");
    let mut errors = Errors::default();
    let (mut count, mut late) = (0.0, 0.0);
    for k in 0..(seconds * arm.rate_hz) as u64 {
        let at = arm.seconds(k);
        let mut sample = arm.sample(k);
        edit(at, &mut sample);
        let estimate = estimator.update_full(&sample);
        if at < 3.0 {
            continue;
        }
        let (truth, found) = (arm.theta(at), fused(&estimate));
        let end = estimator.shape(&estimate, Method::Fusion)[N - 1].end.expect("it is known");
        let [x, y] = tip(truth);
        let error = [end.x.to_f64() - x, end.y.to_f64() - y];
        let covariance = estimator.uncertainties()[N - 1].end.expect("it is known").square_metres();
        count += 1.0;
        errors.within_ellipse += f64::from(u8::from(is_within_ellipse(covariance, error)));
        errors.tip_deviation_mm = (covariance[0] + covariance[2]).sqrt() * 1e3;
        if at > seconds - 60.0 {
            late += 1.0;
            errors.tip_mm += (error[0] * error[0] + error[1] * error[1]) * 1e6;
            for i in 0..N {
                errors.mean[i] += found[i] - truth[i];
                errors.theta[i] = errors.theta[i].max((found[i] - truth[i]).abs());
            }
        }
    }
    errors.within_ellipse /= count;
    errors.mean = errors.mean.map(|sum| sum / late);
    errors.tip_mm = (errors.tip_mm / late).sqrt();
    errors
}

fn ten_minutes(config: &ArmConfig<Q>, edit: impl FnMut(f64, &mut Sample<N>)) -> Errors {
    run(config, &mut drifting(), 600.0, edit)
}

/// Largest of these.
fn largest(values: [f64; N]) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// The IMUs alone would be off by 30° at each segment then, and the bend sensors and the anchor by 2° and the map's
/// 1.5°.
#[test]
fn after_ten_minutes_of_drift_the_shape_is_nearer_than_the_anchor_brings_it() {
    let segments = segments();
    let config = config(&segments, 10.0);
    let filter = ten_minutes(&config, |_, _| {});
    let anchor = ten_minutes(&ArmConfig { bias_filter: None, ..config }, |_, _| {});
    assert!(largest(filter.theta) < 2.0 && filter.tip_mm < 4.0, "{filter:?}");
    assert!(largest(anchor.theta) > 2.0 && anchor.tip_mm > 4.0, "{anchor:?}");
}

#[test]
fn the_tip_is_within_its_95_percent_ellipse() {
    let segments = segments();
    let errors = ten_minutes(&config(&segments, 10.0), |_, _| {});
    assert!(errors.within_ellipse > 0.95, "{errors:?}");
    assert!(errors.tip_deviation_mm < 12.0, "an ellipse of any size would hold: {errors:?}");
}

#[test]
fn ten_and_a_hundred_samples_a_second_give_nearly_the_same() {
    let segments = segments();
    let slow = run(&config(&segments, 10.0), &mut drifting(), 300.0, |_, _| {});
    let fast = run(&config(&segments, 100.0), &mut Arm { rate_hz: 100.0, ..drifting() }, 300.0, |_, _| {});
    for (slow, fast) in slow.mean.into_iter().zip(fast.mean) {
        assert!((slow - fast).abs() < 0.5, "mean errors of {slow} and {fast} degrees");
    }
    assert!(largest(fast.theta) < 2.0 && largest(slow.theta) < 2.0, "{slow:?} and {fast:?}");
}

#[test]
fn a_segment_without_bend_sensors_is_corrected_by_its_neighbours() {
    let mut segments = segments();
    segments[1] = SegmentConfig { bend: [None; 2], ..segments[1] };
    let errors = ten_minutes(&config(&segments, 10.0), |_, _| {});
    // Its own angle is no better than its IMUs; the others are as good as ever.
    assert!(errors.theta[0] < 2.0 && errors.theta[2] < 2.0, "{errors:?}");
    assert!(errors.within_ellipse > 0.95, "{errors:?}");
}

#[test]
fn one_sensor_a_segment_is_enough() {
    let segments = segments().map(|segment| SegmentConfig { bend: [segment.bend[0], None], ..segment });
    let errors = ten_minutes(&config(&segments, 10.0), |_, _| {});
    assert!(largest(errors.theta) < 2.5 && errors.within_ellipse > 0.95, "{errors:?}");
}

#[test]
fn all_imus_may_be_missing_in_every_third_sample() {
    let segments = segments();
    let mut k = 0;
    let errors = ten_minutes(&config(&segments, 10.0), |_, sample| {
        k += 1;
        if k % 3 == 0 {
            sample.imu = [None; N];
        }
    });
    assert!(largest(errors.theta) < 2.5 && errors.within_ellipse > 0.95, "{errors:?}");
}

#[test]
fn each_imu_may_be_missing_in_every_third_sample_in_turn() {
    let segments = segments();
    let mut k = 0;
    let errors = ten_minutes(&config(&segments, 10.0), |_, sample| {
        k += 1;
        sample.imu[k % N] = None;
    });
    assert!(largest(errors.theta) < 2.5 && errors.within_ellipse > 0.95, "{errors:?}");
}

/// Error of each segment at these samples, degrees, largest over those from `from` on.
fn worst_from(
    config: &ArmConfig<Q>,
    arm: &mut Arm,
    samples: impl Iterator<Item = u64>,
    from: u64,
    mut edit: impl FnMut(u64, &mut Sample<N>),
) -> [f64; N] {
    let mut estimator = Estimator::<Q, N, 100>::new(config).expect("a valid configuration");
    let mut worst = [0.0_f64; N];
    for k in samples {
        let mut sample = arm.sample(k);
        edit(k, &mut sample);
        let found = fused(&estimator.update_full(&sample));
        if k >= from {
            let truth = arm.theta(arm.seconds(k));
            worst = core::array::from_fn(|i| worst[i].max((found[i] - truth[i]).abs()));
        }
    }
    worst
}

#[test]
fn after_five_minutes_without_rows_the_bend_sensors_hold_and_the_filter_returns() {
    let segments = segments();
    let config = config(&segments, 10.0);
    let samples = || (0..3000).chain(6000..7800);
    // The bend sensors are off by 2° and the map's 1.5°.
    let at_once = worst_from(&config, &mut drifting(), samples(), 6000, |_, _| {});
    assert!(largest(at_once) < 5.0, "{at_once:?}");
    let later = worst_from(&config, &mut drifting(), samples(), 7200, |_, _| {});
    assert!(largest(later) < 3.0, "{later:?}");
}

#[test]
fn an_imu_that_restarts_after_a_gap_with_another_zero_is_used_again() {
    let segments = segments();
    let restart = |k: u64, sample: &mut Sample<N>| {
        sample.imu[1] = match (k, sample.imu[1]) {
            (0..3000, reading) => reading,
            (3000..3050, _) => None,
            (_, Some(ImuReading::Heading(heading))) => {
                Some(ImuReading::Heading(Phase::from_bits(heading.bits().wrapping_add(1_000_000_000))))
            }
            (_, reading) => reading,
        };
    };
    let worst = worst_from(&config(&segments, 10.0), &mut drifting(), 0..6000, 3000, restart);
    assert!(largest(worst) < 5.0, "{worst:?}");
}

#[test]
fn a_frozen_imu_s_segment_follows_its_bend_sensors() {
    let segments = segments();
    let mut frozen = None;
    let worst = worst_from(&config(&segments, 10.0), &mut Arm::default(), 0..1200, 640, |k, sample| {
        if k >= 600 {
            sample.imu[2] = *frozen.get_or_insert(sample.imu[2]);
        }
    });
    assert!(largest(worst) < 4.0, "{worst:?}");
}

#[test]
fn a_wild_heading_of_50_ms_leaves_nothing() {
    let segments = segments();
    let config = config(&segments, 100.0);
    let arm = || Arm { rate_hz: 100.0, ..drifting() };
    let wild = |k: u64, sample: &mut Sample<N>| {
        if (3000..3005).contains(&k) {
            sample.imu[0] = Some(ImuReading::Heading(Phase::from_degrees(90.0)));
        }
    };
    let without = worst_from(&config, &mut arm(), 0..6000, 3005, |_, _| {});
    let with = worst_from(&config, &mut arm(), 0..6000, 3005, wild);
    for (with, without) in with.into_iter().zip(without) {
        assert!((with - without).abs() < 0.05, "{with} instead of {without} degrees");
    }
}

#[test]
fn a_bend_sensor_that_breaks_away_moves_nothing() {
    let segments = segments();
    let broken = |k: u64, sample: &mut Sample<N>| {
        if k >= 3000 {
            sample.bend[1][0] = Some(counts(70.0));
        }
    };
    let worst = worst_from(&config(&segments, 10.0), &mut drifting(), 0..6000, 3000, broken);
    assert!(largest(worst) < 2.5, "{worst:?}");
}

/// Validity check of an arm's tare (`true`: bad), and the arm's largest error after ten minutes.
fn tared(mut arm: Arm) -> (bool, f64) {
    let segments = segments();
    let config = config(&segments, 10.0);
    let mut estimator = Estimator::<Q, N, 100>::new(&config).expect("a valid configuration");
    let mut worst = 0.0_f64;
    for k in 0..6000 {
        let found = fused(&estimator.update_full(&arm.sample(k)));
        if k >= 5400 {
            let truth = arm.theta(arm.seconds(k));
            worst = worst.max(largest(core::array::from_fn(|i| found[i] - truth[i])));
        }
    }
    (estimator.conditions()[0].tare_bad, worst)
}

#[test]
fn a_tare_at_rest_in_the_reference_pose_is_good() {
    assert!(!tared(drifting()).0);
}

#[test]
fn a_tare_while_bent_is_detected_and_made_up_for() {
    let (is_bad, worst) = tared(Arm { rest: [20.0; N], ..Arm::default() });
    assert!(is_bad && worst < 2.5, "{worst} degrees");
}

#[test]
fn a_tare_while_moving_is_detected_and_made_up_for() {
    let (is_bad, worst) = tared(Arm { rest_until: -3.0, ..Arm::default() });
    assert!(is_bad && worst < 2.5, "{worst} degrees");
}

/// An arm at rest whose middle IMU drifts by 0.05 °/s: 180° in the hour.
fn resting() -> Arm {
    Arm { amplitude: [0.0; N], drift: [0.0, 0.05, 0.0], ..Arm::default() }
}

#[test]
fn at_rest_for_an_hour_the_shape_stays_within_a_degree() {
    let segments = segments();
    let worst = worst_from(&config(&segments, 10.0), &mut resting(), 0..36_000, 300, |_, _| {});
    assert!(largest(worst) < 1.0, "{worst:?}");
}

/// After a rest of a minute the bend sensors fail, and the rate alone corrects the drift.
#[test]
fn at_rest_the_rate_of_the_drift_is_learned() {
    let segments = segments();
    let mut arm = Arm { rest_until: 120.0, amplitude: [20.0; N], ..resting() };
    let worst = worst_from(&config(&segments, 10.0), &mut arm, 0..3000, 300, |k, sample| {
        if k >= 1100 {
            sample.bend = [[None; 2]; N];
        }
    });
    // Without its rate the drift is 9° in 180 s.
    assert!(largest(worst) < 2.0, "{worst:?}");
}

#[test]
fn a_slow_motion_that_the_bend_sensors_show_is_not_taken_for_rest() {
    let segments = segments();
    // 0.25 °/s at the fastest, 40° to either side in 1000 s.
    let mut arm = Arm { amplitude: [40.0; N], period: [1000.0; N], map_error: 0.0, ..Arm::default() };
    let worst = worst_from(&config(&segments, 10.0), &mut arm, 0..10_000, 100, |_, _| {});
    assert!(largest(worst) < 3.0, "{worst:?}");
}

#[test]
fn absolute_headings_are_used_from_the_first_reading_on() {
    let segments = segments();
    let config = ArmConfig { tare_samples: 0, ..config(&segments, 10.0) };
    let mut arm = Arm { rest: [15.0, -20.0, 10.0], map_error: 0.0, ..Arm::default() };
    let worst = worst_from(&config, &mut arm, 0..600, 0, |k, sample| {
        if k < 20 {
            sample.imu[1] = None;
        }
    });
    assert!(largest(worst) < 1.0, "{worst:?}");
}
