use super::BendMonitor;
use crate::config::BendErrorConfig;
use crate::numeric::scalar::TIME_UNIT_S;
use crate::numeric::variance::variance_deg;

const TICK: u64 = 100_000;
const DT: f64 = 0.1 / TIME_UNIT_S;

const ERRORS: BendErrorConfig = BendErrorConfig {
    mean: variance_deg(1.0).q,
    sensor: [variance_deg(1.5).q; 2],
    difference: variance_deg(0.8).q,
    ..BendErrorConfig::PAPER
};

/// A segment that swings by ±30° for a time at 10 Hz, with the readings of a and b at each of its angles, degrees. Gives
/// θ_bend less the angle after each sample, where it is known, and whether one sensor alone is read.
fn swing(
    monitor: &mut BendMonitor<f64>,
    samples: core::ops::Range<u64>,
    mut read: impl FnMut(u64, f64) -> [Option<f64>; 2],
) -> std::vec::Vec<Option<(f64, bool)>> {
    let step = |k: u64| {
        let theta = 30.0 * (k as f64 / 12.0).sin();
        let angles = read(k, theta).map(|angle| angle.map(f64::to_radians));
        let angles = monitor.corrected(angles);
        let motion = Some(theta.to_radians() - 30.0_f64.to_radians() * ((k as f64 - 1.0) / 12.0).sin());
        monitor.find_steps(&ERRORS, angles, motion, DT, k * TICK);
        monitor.check(&ERRORS, angles, theta.to_radians(), k * TICK);
        monitor.compare(angles, DT, k * TICK);
        let bend = monitor.mean(angles, true, k * TICK);
        bend.map(|bend| (bend.theta.to_degrees() - theta, bend.is_single))
    };
    samples.map(step).collect()
}

extern crate std;

#[test]
fn two_sensors_are_read_by_their_mean() {
    let errors = swing(&mut BendMonitor::new(0.0), 0..100, |_, theta| [Some(theta + 2.0), Some(theta - 1.0)]);
    assert!(
        errors.iter().all(|error| error.is_some_and(|(error, is_single)| (error - 0.5).abs() < 1e-9 && !is_single))
    );
}

#[test]
fn a_sensor_that_leaves_its_twin_and_the_imus_is_left_out() {
    let mut monitor = BendMonitor::new(0.0);
    swing(&mut monitor, 0..600, |_, theta| [Some(theta + 1.0), Some(theta - 1.0)]);
    let errors = swing(&mut monitor, 600..700, |_, theta| [Some(theta + 31.0), Some(theta - 1.0)]);
    assert!(errors[1..].iter().all(|error| error.is_some_and(|(error, is_single)| error.abs() < 1.0 && is_single)));
}

#[test]
fn a_sensor_that_was_left_out_is_used_again_20_s_after_it_has_come_back() {
    let mut monitor = BendMonitor::new(0.0);
    swing(&mut monitor, 0..600, |_, theta| [Some(theta), Some(theta)]);
    // It departs by 3° a second: no step.
    swing(&mut monitor, 600..700, |k, theta| [Some(theta + 0.3 * (k - 600) as f64), Some(theta)]);
    swing(&mut monitor, 700..800, |k, theta| [Some(theta + 0.3 * (800 - k) as f64), Some(theta)]);
    let errors = swing(&mut monitor, 800..1100, |_, theta| [Some(theta), Some(theta)]);
    let again = errors.iter().position(|error| error.is_some_and(|(_, is_single)| !is_single));
    // It was within its errors a few seconds before the end of the return.
    assert!(again.is_some_and(|again| (130..=200).contains(&again)), "{again:?}");
}

#[test]
fn sensors_that_leave_the_imus_together_are_both_kept() {
    let mut monitor = BendMonitor::new(0.0);
    swing(&mut monitor, 0..600, |_, theta| [Some(theta), Some(theta)]);
    let departure = |k: u64| 0.2 * (k - 600) as f64;
    let errors = swing(&mut monitor, 600..700, |k, theta| [Some(theta + departure(k)), Some(theta + departure(k))]);
    assert!(errors.iter().all(|error| error.is_some_and(|(_, is_single)| !is_single)));
}

#[test]
fn one_alone_is_read_without_a_step() {
    let mut monitor = BendMonitor::new(0.0);
    swing(&mut monitor, 0..600, |_, theta| [Some(theta + 4.0), Some(theta - 2.0)]);
    for is_a in [true, false] {
        let alone = |_, theta: f64| if is_a { [Some(theta + 4.0), None] } else { [None, Some(theta - 2.0)] };
        let errors = swing(&mut monitor.clone(), 600..650, alone);
        assert!(
            errors.iter().all(|error| error.is_some_and(|(error, is_single)| (error - 1.0).abs() < 0.01 && is_single))
        );
    }
}

#[test]
fn the_difference_is_averaged_from_the_first_sample_on() {
    let mut monitor = BendMonitor::new(0.0);
    // Noise of ±2° on a: the mean over its first second is what counts.
    let noisy = |k: u64, theta: f64| [Some(theta + if k.is_multiple_of(2) { 2.0 } else { -2.0 }), Some(theta)];
    swing(&mut monitor, 0..100, noisy);
    let errors = swing(&mut monitor, 100..101, |_, theta| [None, Some(theta)]);
    assert!(errors[0].is_some_and(|(error, _)| error.abs() < 0.2), "{errors:?}");
}

#[test]
fn a_stuck_sensor_is_left_out() {
    let mut monitor = BendMonitor::new(0.0);
    let stuck = |_, theta: f64| [Some(theta), Some(3.0)];
    swing(&mut monitor, 0..210, stuck);
    let errors = swing(&mut monitor, 210..300, stuck);
    assert!(errors.iter().all(|error| error.is_some_and(|(_, is_single)| is_single)), "{errors:?}");
}

#[test]
fn a_lone_sensor_that_is_stuck_leaves_no_angle() {
    let mut monitor = BendMonitor::new(0.0);
    swing(&mut monitor, 0..210, |_, _| [Some(3.0), None]);
    let errors = swing(&mut monitor, 210..300, |_, _| [Some(3.0), None]);
    assert!(errors.iter().all(Option::is_none), "{errors:?}");
}

#[test]
fn a_sensor_that_was_missing_is_not_taken_for_stuck() {
    let mut monitor = BendMonitor::new(0.0);
    // It is read in one sample of each ten seconds alone.
    let rarely = |k: u64, theta: f64| [Some(theta), (k % 100 == 50).then_some(theta)];
    let errors = swing(&mut monitor, 0..1000, rarely);
    let seen: std::vec::Vec<_> = errors.iter().skip(50).step_by(100).collect();
    assert!(seen.iter().all(|error| error.is_some_and(|(_, is_single)| !is_single)), "{seen:?}");
}

#[test]
fn sensors_that_disagree_widen_the_offset_s_prior() {
    let excess = |half: f64| {
        let mut monitor = BendMonitor::new(0.0);
        swing(&mut monitor, 0..700, |_, theta| [Some(theta + half), Some(theta - half)]);
        monitor.offset_excess(&ERRORS)
    };
    // Two slow deviations of 1.5° and 0.2° are no news.
    assert!(excess(3.0).abs() < 1e-12);
    let expected = variance_deg(10.0 - 3.2).value * ERRORS.slow_ratio.to_f64();
    assert!((excess(10.0) / expected - 1.0).abs() < 0.02, "{} instead of {expected}", excess(10.0));
}

#[test]
fn a_time_at_the_end_of_the_clock_is_survived() {
    let mut monitor = BendMonitor::new(0.0);
    for angles in [[Some(0.0), Some(0.0)], [Some(1.5), Some(-0.5)], [Some(1.5), Some(-0.5)]] {
        monitor.compare(angles, DT, u64::MAX);
        monitor.check(&ERRORS, angles, 0.0, u64::MAX);
    }
}
