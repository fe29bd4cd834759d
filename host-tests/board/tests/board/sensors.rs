//! Every sensor under its own number.

use std::collections::BTreeSet;

use board_tests::Board;
use rig_twin::Scenario;
use telemetry::SensorState;
use virtual_due::WiredRig;

const SEGMENTS: usize = 6;
const BEND_SENSORS: usize = 12;

/// A board whose sensors have all come up.
fn ready() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(1500);
    board
}

#[test]
fn twelve_bend_sensors_and_six_imus_arrive_with_values_of_their_own() {
    let board = ready();
    let sample = board.samples().next_back().expect("samples come");
    let bends: BTreeSet<_> = sample.bend.iter().flatten().collect();
    let imus: BTreeSet<_> = sample.imu.iter().flatten().collect();
    assert_eq!((bends.len(), imus.len()), (BEND_SENSORS, SEGMENTS), "{sample:?}");
}

#[test]
fn the_counts_of_each_bend_sensor_are_those_of_its_strip() {
    let board = ready();
    // The arm rests, so that the twin's strips read the same now as in the last tick, but for noise.
    let strips = board.machine.world().twin().clone().adc_counts().into_iter().flatten();
    let sample = board.samples().next_back().expect("samples come");
    for (sensor, (counts, strip)) in sample.bend.iter().zip(strips).enumerate() {
        let counts = counts.expect("every strip is read");
        assert!(counts.abs_diff(strip) <= 20, "sensor {sensor}: {counts}, its strip {strip}");
    }
}

#[test]
fn the_quaternion_of_each_imu_is_that_of_its_unit() {
    let board = ready();
    let units = board.machine.world().twin().imu_quaternions().into_iter().flatten();
    let sample = board.samples().next_back().expect("samples come");
    for (imu, (read, unit)) in sample.imu.iter().zip(units).enumerate() {
        let read = read.expect("every unit is read");
        let differs = read.iter().zip(unit).any(|(read, unit)| read.abs_diff(unit) > 100);
        assert!(!differs, "IMU {imu}: {read:?}, its unit {unit:?}");
    }
}

#[test]
fn a_bend_sensor_at_a_rail_is_lost_alone() {
    let mut board = ready();
    for sensor in 0..BEND_SENSORS {
        let fault = format!("bend{}{}", sensor / 2 + 1, if sensor % 2 == 0 { "a:short" } else { "b:open" });
        board.inject(&fault);
        board.run_ms(100);
        let sample = board.samples().next_back().expect("samples come");
        let lost: Vec<_> = (0..BEND_SENSORS).filter(|other| sample.bend[*other].is_none()).collect();
        assert_eq!(lost, [sensor]);
        board.clear(&fault);
        // Until it is trusted again.
        board.run_ms(600);
    }
}

#[test]
fn an_unplugged_imu_is_lost_alone() {
    let mut board = ready();
    for imu in 0..SEGMENTS {
        let fault = format!("imu{}:unplugged", imu + 1);
        board.inject(&fault);
        board.run_ms(100);
        let sample = board.samples().next_back().expect("samples come");
        let lost: Vec<_> = (0..SEGMENTS).filter(|other| sample.imu[*other].is_none()).collect();
        assert_eq!(lost, [imu]);
        board.clear(&fault);
        // Until it is found, starts, and reads again.
        board.run_ms(2000);
    }
}

#[test]
fn an_imu_that_is_absent_at_boot_leaves_the_others_running() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.inject("imu3:unplugged");
    board.run_ms(4000);
    let sample = board.samples().next_back().expect("samples come");
    let read: Vec<_> = sample.imu.iter().map(Option::is_some).collect();
    assert_eq!(read, [true, true, false, true, true, true]);
    let health = board.healths().next_back().expect("health comes");
    assert_eq!(health.imu[2].state, SensorState::NoResponse);
    assert_eq!(health.overruns, 0);
    let estimate = board.estimates().next_back().expect("estimates come");
    assert!(estimate.segments.iter().all(Option::is_some), "{estimate:?}");
}

#[test]
fn an_imu_that_is_plugged_in_later_is_taken_in() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.inject("imu5:unplugged");
    board.run_ms(1500);
    board.clear("imu5:unplugged");
    board.run_ms(2000);
    let sample = board.samples().next_back().expect("samples come");
    assert!(sample.imu.iter().all(Option::is_some), "{sample:?}");
}
