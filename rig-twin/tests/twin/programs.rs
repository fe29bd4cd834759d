//! Motions: each moves the arm according to its name.

use crate::recording::{Sample, bends_rad, record_of};
use rig_twin::{Motion, MotionProgram, SEGMENTS, Scenario, Setup};

fn session(scenario: Scenario, motion: Motion, seconds: u32) -> Vec<Sample> {
    record_of(&Setup { motion, ..Setup::new(scenario, 3) }, seconds)
}

/// Speed of the fastest segment between two samples, °/s, through all of a session.
fn speeds_deg_per_s(samples: &[Sample]) -> Vec<f64> {
    let bends: Vec<_> = samples.iter().map(|sample| bends_rad(&sample.truth)).collect();
    let fastest = |pair: &[[f64; SEGMENTS]]| {
        let speeds = pair[0].iter().zip(pair[1]).map(|(before, after)| 10.0 * (after - before).abs().to_degrees());
        speeds.fold(0.0, f64::max)
    };
    bends.windows(2).map(fastest).collect()
}

/// Spread of a segment's bend, degrees.
fn range_deg(samples: &[Sample], segment: usize) -> f64 {
    let bends = samples.iter().map(|sample| bends_rad(&sample.truth)[segment].to_degrees());
    let (low, high) = bends.fold((f64::MAX, f64::MIN), |(low, high), bend| (low.min(bend), high.max(bend)));
    high - low
}

#[test]
fn one_module_moves_one_module_only() {
    let samples = session(Scenario::FreeSwing, Motion::OneModule, 300);
    let moving: Vec<usize> = (0..SEGMENTS).filter(|&segment| range_deg(&samples, segment) > 20.0).collect();
    let still = (0..SEGMENTS).filter(|&segment| range_deg(&samples, segment) < 1e-9).count();
    assert_eq!((moving.len(), still), (2, SEGMENTS - 2), "{moving:?}");
    assert!(moving[0].is_multiple_of(2) && moving[1] == moving[0] + 1, "{moving:?}");
}

#[test]
fn slow_is_slow_and_fast_is_fast() {
    let [slow, swings, fast] = [Motion::Slow, Motion::Swings, Motion::Fast].map(|motion| {
        let speeds = speeds_deg_per_s(&session(Scenario::FreeSwing, motion, 600));
        speeds.iter().sum::<f64>() / speeds.len() as f64
    });
    assert!(slow < 3.0 && slow < 0.2 * swings, "{slow} and {swings} °/s");
    assert!(fast > 2.0 * swings, "{fast} and {swings} °/s");
}

#[test]
fn rests_last_minutes_and_really_rest() {
    let samples = session(Scenario::FreeSwing, Motion::Rests, 7200);
    let speeds = speeds_deg_per_s(&samples);
    // Creep of the silicone, 8 % with 30 s, is slower than this.
    let still: Vec<bool> = speeds.iter().map(|&speed| speed < 0.15).collect();
    let longest = still.split(|&still| !still).map(<[bool]>::len).max().unwrap_or(0);
    assert!(longest > 1200, "the longest rest lasts {longest} samples of 0.1 s");
    let share = still.iter().filter(|&&still| still).count() as f64 / still.len() as f64;
    assert!((0.5..0.999).contains(&share), "it rests for {share} of the time");
}

#[test]
fn rests_hold_the_pressures_for_more_than_half_an_hour_in_a_day() {
    let program = MotionProgram::of(&Setup { motion: Motion::Rests, ..Setup::new(Scenario::FreeSwing, 3) });
    let duties: Vec<_> = (0..86_400).map(|second| program.duties(f64::from(second))).collect();
    let held: Vec<bool> = duties
        .windows(2)
        .map(|pair| pair[0].iter().zip(&pair[1]).all(|(now, next)| now.to_bits() == next.to_bits()))
        .collect();
    let longest = held.split(|&held| !held).map(<[bool]>::len).max().unwrap_or(0);
    assert!(longest > 1800, "{longest} s");
}

#[test]
fn leans_last_minutes_far_from_straight() {
    let samples = session(Scenario::FreeSwing, Motion::Lean, 1800);
    let mean_bend_deg = |window: &[Sample], segment: usize| {
        window.iter().map(|sample| bends_rad(&sample.truth)[segment].to_degrees()).sum::<f64>() / window.len() as f64
    };
    let leans = samples.chunks(600).filter(|window| {
        (0..SEGMENTS).all(|segment| mean_bend_deg(window, segment).abs() > 10.0 && range_deg(window, segment) < 20.0)
    });
    assert!(leans.count() >= 4, "at least four minutes of half an hour");
}

#[test]
fn bent_start_is_bent_and_still_in_the_first_seconds() {
    let samples = session(Scenario::FreeSwing, Motion::BentStart, 5);
    assert!((0..SEGMENTS).all(|segment| bends_rad(&samples[0].truth)[segment].abs() > 0.1));
    assert!(speeds_deg_per_s(&samples).iter().all(|&speed| speed < 0.5));
}

#[test]
fn bent_start_at_the_obstacle_is_in_contact_from_the_first_sample() {
    for seed in 1..=5 {
        let setup = Setup { motion: Motion::BentStart, ..Setup::new(Scenario::Obstacle, seed) };
        let first = &record_of(&setup, 1)[0];
        assert!(first.contact_bends_rad[3].abs() > 0.01, "seed {seed}: {:?}", first.contact_bends_rad);
    }
}

#[test]
fn moving_start_moves_in_the_first_second() {
    let speeds = speeds_deg_per_s(&session(Scenario::FreeSwing, Motion::MovingStart, 5));
    assert!(speeds.iter().all(|&speed| speed > 1.0), "{speeds:?}");
}

#[test]
fn every_motion_runs_under_every_scenario_within_the_range_of_the_converter() {
    for scenario in [Scenario::FreeSwing, Scenario::Push, Scenario::Obstacle] {
        for motion in [Motion::Slow, Motion::Fast, Motion::Lean, Motion::BentStart, Motion::MovingStart] {
            for sample in session(scenario, motion, 60) {
                assert!(sample.counts.iter().all(|count| (400..3700).contains(count)), "{scenario:?}, {motion:?}");
            }
        }
    }
}
