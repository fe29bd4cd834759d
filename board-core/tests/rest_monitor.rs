//! The range of the headings before a tare.

use board_core::{REST_RANGE, RestMonitor};

/// A quaternion about the vertical, of a heading in degrees.
fn heading(degrees: f64) -> [i16; 4] {
    let half = degrees.to_radians() / 2.0;
    [half.cos(), 0.0, 0.0, half.sin()].map(|component| (component * 16384.0).round() as i16)
}

fn degrees(range: i32) -> f64 {
    (f64::from(range) / f64::from(1 << 26)).to_degrees()
}

/// The most turned segment after these headings of two segments, in degrees.
fn most_turned(headings: impl IntoIterator<Item = [[i16; 4]; 2]>) -> Option<(u8, f64)> {
    most_turned_with_gaps(headings.into_iter().map(|imu| imu.map(Some)))
}

fn most_turned_with_gaps(headings: impl IntoIterator<Item = [Option<[i16; 4]>; 2]>) -> Option<(u8, f64)> {
    let mut monitor = RestMonitor::new();
    headings.into_iter().for_each(|imu| monitor.step(&imu));
    monitor.most_turned().map(|(segment, range)| (segment, degrees(range)))
}

#[test]
fn the_segment_that_turns_most_is_named_with_its_range() {
    for start in [0.0, 179.0, -180.0, 725.0] {
        let turning = (0..100).map(|tick| [heading(start), heading(start + 0.1 * f64::from(tick))]);
        let (segment, range) = most_turned(turning).expect("both were read");
        assert_eq!(segment, 1);
        // 0.25 s to 0.5 s of 10 °/s.
        assert!((2.4..=5.0).contains(&range), "{range}°");
    }
}

#[test]
fn there_and_back_counts_as_turned() {
    let there_and_back = (0..100).map(|tick| [heading(if tick % 20 < 10 { 0.0 } else { 4.0 }), heading(0.0)]);
    let (segment, range) = most_turned(there_and_back).expect("both were read");
    assert_eq!(segment, 0);
    assert!((range - 4.0).abs() < 0.05, "{range}°");
}

#[test]
fn a_motion_is_forgotten_after_half_a_second_of_rest() {
    let rests = (0..151).map(|tick| [heading(if tick < 100 { f64::from(tick) } else { 99.0 }), heading(0.0)]);
    let (_, range) = most_turned(rests).expect("both were read");
    assert!(range < 0.01, "{range}°");
}

#[test]
fn an_imu_that_was_not_read_in_every_tick_says_nothing() {
    let gap = (0..100).map(|tick| [(tick != 80).then(|| heading(f64::from(tick))), Some(heading(0.0))]);
    assert_eq!(most_turned_with_gaps(gap).map(|(segment, _)| segment), Some(1));
    assert_eq!(most_turned_with_gaps((0..100).map(|_| [None, None])), None);
}

#[test]
fn an_arm_is_at_rest_up_to_one_degree() {
    assert!((degrees(REST_RANGE) - 1.0).abs() < 1e-4);
}
