//! IMUs on any channel and at either address.

use board_core::imus::ImuReadings;
use board_table::{ImuAddress, Wiring};
use telemetry::SensorState;

mod imu_rig;
use imu_rig::{ImuRig, heading};

/// An arm whose segments have these IMUs.
fn wiring<const N: usize>(imus: [Option<(u8, u8)>; N]) -> Wiring {
    let mut wiring = Wiring::reference(N);
    for (segment, imu) in wiring.segments.iter_mut().zip(imus) {
        segment.imu = imu.map(|(channel, address)| ImuAddress { channel, address });
    }
    wiring
}

fn running(wiring: &Wiring) -> (ImuRig, ImuReadings) {
    let mut rig = ImuRig::wired(wiring);
    rig.ticks(10);
    let readings = rig.tick();
    (rig, readings)
}

#[test]
fn each_segment_gets_the_reading_of_its_own_imu() {
    // Two share a channel, and the order of the channels is not that of the segments.
    let (_, readings) = running(&wiring([Some((7, 0x29)), Some((2, 0x28)), Some((7, 0x28))]));
    assert_eq!(readings.imu, [10.0, 20.0, 30.0].map(|degrees| Some(heading(degrees))));
}

#[test]
fn eight_imus_are_read_in_time() {
    let mut rig = ImuRig::wired(&Wiring::reference(8));
    rig.ticks(10);
    for _ in 0..100 {
        assert!(rig.tick().imu.iter().all(Option::is_some));
        assert!(rig.wire_us() < 4_100.0, "{} µs", rig.wire_us());
    }
}

#[test]
fn a_segment_without_an_imu_has_no_reading_and_no_fault() {
    let (rig, readings) = running(&wiring([Some((0, 0x28)), None, Some((1, 0x28))]));
    assert_eq!(readings.imu, [Some(heading(10.0)), None, Some(heading(30.0))]);
    let (ok, not_wired) = (SensorState::Ok, SensorState::NotWired);
    let health = rig.imus.health();
    assert_eq!(health.iter().map(|imu| imu.state).collect::<Vec<_>>(), [ok, not_wired, ok]);
    assert_eq!(health[1].missed, 0);
    assert!(readings.all_are_read(&health), "the first tare does not wait for an IMU that is not wired");
}

#[test]
fn a_wired_imu_that_is_missing_is_not_taken_for_one_that_is_not_wired() {
    let mut rig = ImuRig::wired(&Wiring::reference(2));
    rig.bus().chips[1].is_plugged = false;
    rig.ticks(10);
    let readings = rig.tick();
    assert_eq!((readings.imu[1], rig.imus.health()[1].state), (None, SensorState::NoResponse));
    assert!(!readings.all_are_read(&rig.imus.health()));
}
