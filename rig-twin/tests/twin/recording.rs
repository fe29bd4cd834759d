//! Sessions recorded at 10 Hz, and the angles in them.

use rig_twin::{BEND_SENSORS, EndPose, MotionProgram, Rig, SEGMENTS, Scenario, Setup};
use std::f64::consts::TAU;

/// Values of one tick of a session.
pub struct Sample {
    pub counts: [u16; BEND_SENSORS],
    pub quaternions: [[i16; 4]; SEGMENTS],
    pub truth: [EndPose; SEGMENTS],
    pub contact_bends_rad: [f64; SEGMENTS],
}

pub fn record(scenario: Scenario, seed: u64, seconds: u32) -> Vec<Sample> {
    record_of(&Setup::new(scenario, seed), seconds)
}

/// A session of any setup.
pub fn record_of(setup: &Setup, seconds: u32) -> Vec<Sample> {
    let (program, mut rig) = (MotionProgram::of(setup), Rig::of(setup));
    let sample = |_| {
        for _ in 0..10 {
            rig.step(0.01, &program.duties(rig.time_s()));
        }
        Sample {
            counts: counts(&mut rig),
            quaternions: quaternions(&rig),
            truth: truth(&rig),
            contact_bends_rad: whole(rig.contact_bends_rad()),
        }
    };
    (0..10 * seconds).map(sample).collect()
}

/// Counts of all bend sensors.
pub fn counts(rig: &mut Rig) -> [u16; BEND_SENSORS] {
    whole(rig.adc_counts().into_iter().flatten())
}

/// Quaternions of all IMUs.
pub fn quaternions(rig: &Rig) -> [[i16; 4]; SEGMENTS] {
    whole(rig.imu_quaternions().into_iter().flatten())
}

/// True poses of all segments' ends.
pub fn truth(rig: &Rig) -> [EndPose; SEGMENTS] {
    whole(rig.truth())
}

/// Values of an arm of six segments.
fn whole<T, const COUNT: usize>(values: impl IntoIterator<Item = T>) -> [T; COUNT] {
    values.into_iter().collect::<Vec<T>>().try_into().ok().expect("the arm has six segments and all sensors")
}

/// True bend angles: differences of neighbouring headings.
pub fn bends_rad(truth: &[EndPose; SEGMENTS]) -> [f64; SEGMENTS] {
    differences(truth.map(|pose| pose.heading_rad))
}

/// Each heading minus the one before it; the base's is 0.
pub fn differences(headings_rad: [f64; SEGMENTS]) -> [f64; SEGMENTS] {
    std::array::from_fn(|i| headings_rad[i] - if i > 0 { headings_rad[i - 1] } else { 0.0 })
}

/// Heading of a quaternion, clockwise positive.
pub fn heading_rad(quaternion: [i16; 4]) -> f64 {
    let [w, x, y, z] = quaternion.map(|step| f64::from(step) / 16384.0);
    -(2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z))
}

/// Headings of all samples, unwrapped, minus those of the first second.
pub fn tared_headings_rad(samples: &[Sample]) -> Vec<[f64; SEGMENTS]> {
    let mut last = samples[0].quaternions.map(heading_rad);
    let mut headings: Vec<[f64; SEGMENTS]> = samples
        .iter()
        .map(|sample| {
            last = std::array::from_fn(|i| {
                let turn = heading_rad(sample.quaternions[i]) - last[i];
                last[i] + turn - TAU * (turn / TAU).round()
            });
            last
        })
        .collect();
    let tare: [f64; SEGMENTS] = std::array::from_fn(|i| headings[..10].iter().map(|row| row[i]).sum::<f64>() / 10.0);
    for row in &mut headings {
        *row = std::array::from_fn(|i| row[i] - tare[i]);
    }
    headings
}

pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / count)
}
