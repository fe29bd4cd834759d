use super::{RestDetector, RestWindow};
use crate::numeric::phase::Turns;
use crate::numeric::scalar::TIME_UNIT_S;

extern crate std;

const SECOND: u64 = 1_000_000;

fn degrees(degrees: f64) -> Turns {
    Turns::from_rad(degrees.to_radians())
}

/// Headings and bend angles at 10 Hz as functions of the time in s, degrees; returns the windows of rest and their end
/// times.
fn run(
    detector: &mut RestDetector<f64, 1>,
    seconds: core::ops::Range<u64>,
    heading: impl Fn(f64) -> Option<f64>,
    bend: impl Fn(f64) -> Option<f64>,
) -> std::vec::Vec<(f64, RestWindow<f64, 1>)> {
    let mut windows = std::vec::Vec::new();
    for k in seconds.start * 10..seconds.end * 10 {
        let at = k as f64 / 10.0;
        detector.update(0, heading(at).map(degrees), bend(at).map(degrees), 0.1 / TIME_UNIT_S);
        if let Some(window) = detector.window(k * SECOND / 10) {
            windows.push((at, window));
        }
    }
    windows
}

#[test]
fn the_rate_is_seen_after_twenty_seconds_of_rest() {
    let windows = run(&mut RestDetector::new(0.0), 0..60, |at| Some(0.05 * at), |_| Some(0.0));
    let (first, _) = windows[0];
    assert!((first - 20.0).abs() < 0.2, "{first} s");
}

#[test]
fn a_window_shows_the_drift() {
    let windows = run(&mut RestDetector::new(0.0), 0..60, |at| Some(0.05 * at), |_| Some(0.0));
    for (at, window) in windows {
        let change = window.headings[0].expect("it is read").to_degrees();
        assert!((change / (window.length_us as f64 * 1e-6) - 0.05).abs() < 0.001, "{change} degrees at {at} s");
    }
}

#[test]
fn a_swing_is_no_rest() {
    let swing = |at: f64| Some(5.0 * at.sin());
    assert!(run(&mut RestDetector::new(0.0), 0..120, swing, swing).is_empty());
}

#[test]
fn a_slow_motion_that_the_bend_sensors_show_is_no_rest() {
    let slow = |at: f64| Some(0.2 * at);
    assert!(run(&mut RestDetector::new(0.0), 0..120, |at| Some(0.1 * at), slow).is_empty());
}

#[test]
fn a_drift_that_the_bend_sensors_do_not_show_is_rest() {
    assert!(!run(&mut RestDetector::new(0.0), 0..120, |at| Some(0.1 * at), |_| Some(10.0)).is_empty());
}

#[test]
fn motion_ends_the_rest() {
    let mut detector = RestDetector::new(0.0);
    run(&mut detector, 0..60, |_| Some(0.0), |_| Some(0.0));
    assert!(detector.is_resting());
    let swing = |at: f64| Some(20.0 * at.sin());
    run(&mut detector, 60..71, swing, swing);
    assert!(!detector.is_resting());
}

#[test]
fn a_gap_ends_the_rest() {
    let mut detector = RestDetector::new(0.0);
    run(&mut detector, 0..60, |_| Some(0.0), |_| Some(0.0));
    run(&mut detector, 120..121, |_| Some(0.0), |_| Some(0.0));
    assert!(!detector.is_resting());
}

#[test]
fn a_heading_that_is_not_read_has_no_change() {
    let windows = run(&mut RestDetector::new(0.0), 0..60, |at| (at < 30.0).then_some(0.0), |_| Some(0.0));
    assert!(windows.iter().any(|(_, window)| window.headings[0].is_some()));
    assert!(windows.iter().filter(|(at, _)| *at > 31.0).all(|(_, window)| window.headings[0].is_none()));
}
