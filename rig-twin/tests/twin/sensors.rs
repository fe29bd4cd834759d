//! Raw readings: bend sensors that never saturate, IMUs that drift and hold.

use crate::recording::{counts, heading_rad, quaternions, record, tared_headings_rad};
use rig_twin::{Rig, SEGMENTS, Scenario};

#[test]
fn bend_sensors_do_not_saturate() {
    for scenario in [Scenario::Sweep, Scenario::FreeSwing, Scenario::Push, Scenario::Obstacle] {
        for sample in record(scenario, 2, 300) {
            assert!(sample.counts.iter().all(|count| (400..3700).contains(count)), "{:?}", sample.counts);
        }
    }
}

#[test]
fn converter_noise_is_two_counts() {
    let mut rig = Rig::new(Scenario::FreeSwing, 1);
    rig.step(1.0, &[0.0; 6]);
    let counts: Vec<f64> = (0..5000).map(|_| f64::from(counts(&mut rig)[0])).collect();
    let mean = counts.iter().sum::<f64>() / 5000.0;
    let variance = counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / 5000.0;
    assert!((1.7..2.4).contains(&variance.sqrt()), "{} counts", variance.sqrt());
}

#[test]
fn worst_imu_drifts_45_degrees_in_900_seconds() {
    for seed in 1..=3 {
        let mut rig = Rig::new(Scenario::FreeSwing, seed);
        let mut turned = [0.0; SEGMENTS];
        let mut last = quaternions(&rig).map(heading_rad);
        for _ in 0..900 {
            rig.step(1.0, &[0.0; 6]);
            let next = quaternions(&rig).map(heading_rad);
            for segment in 0..SEGMENTS {
                let turn = next[segment] - last[segment];
                turned[segment] += turn.sin().atan2(turn.cos());
            }
            last = next;
        }
        let worst = turned.iter().fold(0.0_f64, |worst, turn| worst.max(turn.abs())).to_degrees();
        assert!((worst - 45.0).abs() < 4.5, "seed {seed}: {worst}°");
    }
}

#[test]
fn others_drift_less_and_both_ways() {
    let samples = record(Scenario::FreeSwing, 2, 900);
    let headings = tared_headings_rad(&samples);
    let (measured, truth) = (headings[headings.len() - 1], samples[samples.len() - 1].truth);
    let drifts: Vec<f64> = (0..SEGMENTS - 1).map(|i| (measured[i] - truth[i].heading_rad).to_degrees()).collect();
    assert!(drifts.iter().all(|drift| drift.abs() < 20.0), "{drifts:?}");
    assert!(drifts.iter().any(|&drift| drift > 2.0) && drifts.iter().any(|&drift| drift < -2.0), "{drifts:?}");
}

#[test]
fn swings_disturb_the_heading_by_a_degree_or_two() {
    let samples = record(Scenario::FreeSwing, 2, 300);
    let headings = tared_headings_rad(&samples);
    let truths = samples.iter().map(|sample| sample.truth[SEGMENTS - 1].heading_rad);
    let errors: Vec<f64> =
        headings.iter().zip(truths).map(|(row, truth)| (row[SEGMENTS - 1] - truth).to_degrees()).collect();
    // Drift is the same over 10 s as its mean; white noise alone peaks below 0.5°.
    let peak =
        errors.windows(101).map(|window| (window[50] - window.iter().sum::<f64>() / 101.0).abs()).fold(0.0, f64::max);
    assert!((0.8..3.0).contains(&peak), "{peak}°");
}

#[test]
fn quaternions_are_unit_and_not_a_pure_yaw() {
    for sample in record(Scenario::FreeSwing, 2, 60) {
        for quaternion in sample.quaternions {
            let [w, x, y, z] = quaternion.map(|step| f64::from(step) / 16384.0);
            assert!((w * w + x * x + y * y + z * z - 1.0).abs() < 3e-4, "{quaternion:?}");
            assert!(x.hypot(y) > 1e-3, "{quaternion:?}");
        }
    }
}

#[test]
fn fusion_output_holds_for_ten_milliseconds() {
    let mut rig = Rig::new(Scenario::FreeSwing, 1);
    rig.step(0.01, &[1.0; 6]);
    let fused = rig.imu_quaternions();
    rig.step(0.008, &[1.0; 6]);
    assert_eq!(rig.imu_quaternions(), fused);
    rig.step(0.002, &[1.0; 6]);
    assert_ne!(rig.imu_quaternions(), fused);
}
