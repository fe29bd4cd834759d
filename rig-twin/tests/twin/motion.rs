//! Scenarios: motion and contacts of the arm.

use crate::recording::{Sample, bends_rad, record, truth};
use rig_twin::{MotionProgram, Rig, SEGMENTS, Scenario};

const ALL: [Scenario; 4] = [Scenario::Sweep, Scenario::FreeSwing, Scenario::Push, Scenario::Obstacle];

fn extremes_deg(samples: &[Sample], segment: usize) -> (f64, f64) {
    let bends = samples.iter().map(|sample| bends_rad(&sample.truth)[segment].to_degrees());
    bends.fold((0.0, 0.0), |(low, high), bend| (f64::min(low, bend), f64::max(high, bend)))
}

#[test]
fn arm_rests_straight_for_five_seconds() {
    for scenario in ALL {
        for sample in record(scenario, 2, 5) {
            let tip = sample.truth[SEGMENTS - 1];
            assert!(tip.x_m.abs() < 1e-9 && (tip.y_m - 0.582).abs() < 1e-9, "{scenario:?}: {tip:?}");
        }
    }
}

#[test]
fn arm_moves_after_its_rest() {
    for scenario in ALL {
        let samples = record(scenario, 2, 20);
        let moves = (0..SEGMENTS).all(|segment| extremes_deg(&samples, segment) != (0.0, 0.0));
        assert!(moves, "{scenario:?}");
    }
}

#[test]
fn sweep_bends_every_segment_both_ways_through_its_range() {
    let samples = record(Scenario::Sweep, 2, 600);
    for segment in 0..SEGMENTS {
        let (low, high) = extremes_deg(&samples, segment);
        assert!(low < -48.0 && high > 48.0, "segment {}: {low}° to {high}°", segment + 1);
    }
}

#[test]
fn segments_of_a_module_do_not_bend_alike() {
    let samples = record(Scenario::Sweep, 2, 100);
    let apart = samples.iter().map(|sample| {
        let bends = bends_rad(&sample.truth);
        (bends[0] - bends[1]).abs().to_degrees()
    });
    assert!(apart.fold(0.0, f64::max) > 0.5);
}

#[test]
fn swings_keep_the_heading_within_200_degrees() {
    for scenario in [Scenario::FreeSwing, Scenario::Push, Scenario::Obstacle] {
        for sample in record(scenario, 4, 300) {
            let heading = sample.truth[SEGMENTS - 1].heading_rad.to_degrees();
            assert!(heading.abs() < 200.0, "{scenario:?}: {heading}°");
        }
    }
}

#[test]
fn duties_change_smoothly() {
    for scenario in ALL {
        let program = MotionProgram::new(scenario, 9);
        for tick in 0..60_000 {
            let [now, next] = [tick, tick + 1].map(|tick| program.duties(f64::from(tick) * 0.01));
            let step = now.iter().zip(next).map(|(now, next)| (next - now).abs()).fold(0.0, f64::max);
            assert!(step < 0.03, "{scenario:?}: {step} in 10 ms at tick {tick}");
        }
    }
}

#[test]
fn nothing_touches_the_arm_in_the_sweep_and_in_scenario_one() {
    for scenario in [Scenario::Sweep, Scenario::FreeSwing] {
        for sample in record(scenario, 2, 60) {
            assert!(sample.contact_bends_rad.iter().all(|bend| bend.abs() < f64::EPSILON), "{scenario:?}");
        }
    }
}

#[test]
fn pushes_bend_the_pushed_segment_by_more_than_ten_degrees() {
    let program = MotionProgram::new(Scenario::Push, 2);
    let mut pushed = Rig::new(Scenario::Push, 2);
    let mut free = Rig::new(Scenario::FreeSwing, 2);
    let mut largest_deg = [0.0_f64; SEGMENTS];
    for _ in 0..60_000 {
        let duties = program.duties(pushed.time_s());
        pushed.step(0.01, &duties);
        free.step(0.01, &duties);
        let (with, without) = (bends_rad(&truth(&pushed)), bends_rad(&truth(&free)));
        for (largest, (with, without)) in largest_deg.iter_mut().zip(with.iter().zip(without)) {
            *largest = largest.max((with - without).abs().to_degrees());
        }
    }
    assert!(largest_deg.iter().all(|&largest| largest > 10.0 && largest < 30.0), "{largest_deg:?}");
    assert!(pushed.pushes().len() > 40, "{} pushes in 600 s", pushed.pushes().len());
}

#[test]
fn obstacle_deflects_the_arm_part_of_the_time() {
    let samples = record(Scenario::Obstacle, 2, 300);
    let wrapped = samples.iter().filter(|sample| sample.contact_bends_rad[3].abs() > 0.1).count();
    let share = wrapped as f64 / samples.len() as f64;
    assert!(share > 0.15 && share < 0.8, "wraps for {share} of the time");
}
