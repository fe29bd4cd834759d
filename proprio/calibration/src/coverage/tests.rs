//! Coverage of sweeps of the simulated arm.

use calibration_tables::MAX_SEGMENTS;
use estimator_core::{ImuReading, Sample};
use proprio_session::Row;
use proprio_simulation::{Recorded, Simulation};
use rig_twin::{Scenario, Setup};

use super::{SweepCoverage, SweepFault, SweepReport};

const SEGMENTS: usize = 6;

/// The report of a sweep of an arm; `change` changes each sample.
fn swept(arm_seed: u64, seconds: f64, mut change: impl FnMut(&mut Recorded)) -> SweepReport {
    let setup = Setup { arm_seed, ..Setup::new(Scenario::Sweep, 5) };
    let mut coverage = SweepCoverage::new(SEGMENTS);
    for (number, mut recorded) in Simulation::of(&setup, seconds, 10.0).expect("a valid run").enumerate() {
        change(&mut recorded);
        let mut sample = Sample::<MAX_SEGMENTS>::missing(recorded.time_us);
        for i in 0..SEGMENTS {
            sample.bend[i] = [recorded.counts[2 * i], recorded.counts[2 * i + 1]];
            sample.imu[i] = recorded.quaternions[i].map(ImuReading::from_bno055);
        }
        coverage.update(&Row { sample, truth: [None; MAX_SEGMENTS], starts: number == 0, board: None });
    }
    coverage.report()
}

/// A sweep with a change from half a minute on.
fn spoiled(change: impl Fn(&mut Recorded, &Recorded)) -> Vec<SweepFault> {
    let mut before = None;
    let report = swept(0, 120.0, |recorded| {
        let first = before.get_or_insert_with(|| recorded.clone()).clone();
        if recorded.time_us > 30_000_000 {
            change(recorded, &first);
        }
    });
    report.faults
}

#[test]
fn a_sweep_of_ten_minutes_has_the_range_and_the_passes_that_a_calibration_needs() {
    let report = swept(0, 600.0, |_| {});
    assert!((report.seconds - 599.9).abs() < 0.01, "{}", report.seconds);
    let rest = report.rest.expect("there are IMUs");
    assert!(rest.turned_deg < 1.5, "{rest:?}");
    for segment in &report.segments {
        // Under the camera it bends by 56° to 60° both ways. The IMUs have drifted by up to 30°.
        let [low, high] = segment.ends_deg.expect("there are IMUs");

        assert!((-67.0..-50.0).contains(&low) && (50.0..68.0).contains(&high), "{segment:?}");
        assert_eq!(segment.seen_deg.len(), 1, "{segment:?}");
        assert!(segment.passes >= report.goal.passes, "{segment:?}");
    }
    assert_eq!(report.faults, []);
}

#[test]
fn the_two_segments_of_a_module_bend_alike() {
    assert_eq!(swept(0, 120.0, |_| {}).coupled, [[1, 2], [3, 4], [5, 6]]);
}

#[test]
fn good_sensors_of_other_arms_are_no_fault() {
    for arm_seed in 1..=6 {
        assert_eq!(swept(arm_seed, 200.0, |_| {}).faults, [], "arm {arm_seed}");
    }
}

#[test]
fn a_bend_sensor_whose_readings_stay_is_named() {
    let faults = spoiled(|now, first| now.counts[2] = first.counts[2]);
    assert_eq!(faults, [SweepFault::BendStays { segment: 2, place: 0 }]);
}

#[test]
fn a_bend_sensor_that_moves_with_another_module_is_named() {
    let faults = spoiled(|now, _| now.counts[5] = now.counts[9]);
    assert_eq!(faults, [SweepFault::BendUnrelated { segment: 3, place: 1 }]);
}

#[test]
fn an_imu_that_stays_is_named_and_neither_its_neighbours_nor_bend_sensors() {
    for imu in 0..SEGMENTS {
        let faults = spoiled(|now, first| now.quaternions[imu] = first.quaternions[imu]);
        assert_eq!(faults, [SweepFault::ImuStays { segment: imu + 1 }]);
    }
}

#[test]
fn an_imu_that_turns_with_another_segment_is_named() {
    let faults = spoiled(|now, _| now.quaternions[3] = now.quaternions[0]);
    assert_eq!(faults, [SweepFault::ImuUnrelated { segment: 4 }]);
    // Beyond the last one there is no segment that could tell it from its bend sensors.
    let faults = spoiled(|now, _| now.quaternions[5] = now.quaternions[0]);
    assert_eq!(faults, [SweepFault::Segment { segment: 6 }]);
}

#[test]
fn imus_that_are_read_later_than_the_bend_sensors_have_their_passes() {
    let report = swept(0, 300.0, |now| {
        if now.time_us < 1_000_000 {
            now.quaternions.fill(None);
        }
    });
    assert!(report.segments.iter().all(|segment| segment.passes >= 10), "{report:?}");
}

#[test]
fn without_imus_passes_are_those_of_the_bend_sensors_and_no_angle_is_reported() {
    let report = swept(0, 300.0, |now| now.quaternions.fill(None));
    assert_eq!((report.rest, report.faults), (None, Vec::new()));
    for segment in &report.segments {
        assert_eq!((segment.ends_deg, segment.seen_deg.len()), (None, 0));
        let [low, high] = segment.counts[0].expect("it is read");
        assert!(high - low > 300 && segment.passes >= 10, "{segment:?}");
    }
}
