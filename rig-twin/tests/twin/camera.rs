//! The camera: its frames and its clock.

use rig_twin::{Camera, EndPose, Frame, SEGMENTS};

/// Frames of an arm that stands still in one pose.
fn frames(seed: u64, pose: EndPose, count: usize) -> Vec<Option<Frame>> {
    let mut camera = Camera::new(seed);
    (0..count).map(|_| camera.take(&[pose; SEGMENTS])).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn the_base_and_a_pose_ahead_of_it_are_seen_in_line_with_the_bases_heading() {
    let ahead = EndPose { x_m: 0.0, y_m: 0.5, heading_rad: 0.3 };
    let seen: Vec<Frame> = frames(1, ahead, 3000).into_iter().flatten().collect();
    let base = |of: fn(&EndPose) -> f64| mean(seen.iter().filter_map(|frame| frame.base.as_ref()).map(of));
    let end = |of: fn(&EndPose) -> f64| mean(seen.iter().filter_map(|frame| frame.ends[2].as_ref()).map(of));
    let heading_rad = base(|pose| pose.heading_rad);
    assert!((end(|pose| pose.x_m) - base(|pose| pose.x_m) - 0.5 * heading_rad.sin()).abs() < 2e-4);
    assert!((end(|pose| pose.y_m) - base(|pose| pose.y_m) - 0.5 * heading_rad.cos()).abs() < 2e-4);
    assert!((end(|pose| pose.heading_rad) - heading_rad - 0.3).abs() < 1e-3);
}

#[test]
fn its_headings_are_within_half_a_turn() {
    let curled = EndPose { x_m: 0.1, y_m: 0.1, heading_rad: 7.0 };
    let mut headings = frames(2, curled, 100).into_iter().flatten().filter_map(|frame| frame.ends[5]);
    assert!(headings.all(|pose| pose.heading_rad.abs() <= core::f64::consts::PI));
}

#[test]
fn it_loses_some_frames_and_some_markers() {
    let all = frames(3, EndPose::default(), 10_000);
    let seen: Vec<&Frame> = all.iter().flatten().collect();
    assert!((9500..9900).contains(&seen.len()), "{} frames", seen.len());
    let hidden = seen.iter().filter(|frame| frame.ends[0].is_none()).count();
    assert!((10..150).contains(&hidden), "{hidden} times");
}

#[test]
fn its_clock_is_80_ppm_fast() {
    let mut camera = Camera::new(4);
    let frames =
        (0..30_000).filter_map(|_| Some((camera.next_s(), camera.take(&[EndPose::default(); SEGMENTS])?.time_s)));
    let ahead: Vec<f64> = frames.map(|(taken_s, time_s)| time_s - 1.76e9 - taken_s).collect();
    let tenth = ahead.len() / 10;
    // Over nine tenths of 1000 s, from means of 3000 stamps that are good to 2 ms each.
    let gained_s = mean(ahead[9 * tenth..].iter().copied()) - mean(ahead[..tenth].iter().copied());
    assert!((gained_s - 900.0 * 80e-6).abs() < 5e-4, "{gained_s} s");
}

#[test]
fn the_same_seed_sees_the_same() {
    let pose = EndPose { x_m: 0.1, y_m: 0.2, heading_rad: 0.3 };
    assert_eq!(frames(5, pose, 500), frames(5, pose, 500));
    assert_ne!(frames(5, pose, 500), frames(6, pose, 500));
}
