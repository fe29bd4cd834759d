//! States of IMUs that read: copies of another, intermittent and implausible ones.

use telemetry::{Event, SensorState};

mod imu_rig;
use imu_rig::{ImuRig, heading, measured, moving_tick, state, ticks_until};

#[test]
fn two_imus_with_the_same_changing_bytes_are_both_invalid_within_50_ms_and_back_when_they_differ() {
    let mut rig = ImuRig::running();
    let mut last = Vec::new();
    for turn in 1..=5 {
        for (k, chip) in rig.bus().chips.iter_mut().enumerate() {
            let k = if k == 3 { 2 } else { k };
            chip.quaternion = measured(k, turn);
        }
        last = rig.tick().imu.to_vec();
    }
    assert_eq!((state(&rig, 2), state(&rig, 3)), (SensorState::Invalid, SensorState::Invalid));
    assert_eq!((last[2], last[3], last[1]), (None, None, Some(measured(1, 5))));
    let readings = moving_tick(&mut rig);
    assert!(readings.imu[2].is_some() && readings.imu[3].is_some());
    assert_eq!((state(&rig, 2), state(&rig, 3)), (SensorState::Ok, SensorState::Ok));
}

#[test]
fn two_imus_at_rest_may_read_the_same() {
    let mut rig = ImuRig::powered_up();
    rig.bus().chips[3].quaternion = heading(30.0);
    rig.ticks(10);
    for _ in 0..1000 {
        assert!(rig.tick().events.is_empty());
    }
}

#[test]
fn an_imu_that_misses_every_other_reading_is_intermittent_and_its_readings_are_used() {
    let mut rig = ImuRig::running();
    let mut read = 0;
    for tick in 0..20 {
        rig.bus().chips[3].is_plugged = tick % 2 == 1;
        read += usize::from(moving_tick(&mut rig).imu[3].is_some());
    }
    assert_eq!((state(&rig, 3), read), (SensorState::Intermittent, 10));
    assert!(ticks_until(&mut rig, 3, SensorState::Ok, 101) > 50);
}

#[test]
fn an_imu_that_the_estimator_finds_implausible_is_inconsistent_at_once_and_is_read() {
    let mut rig = ImuRig::running();
    let mut events = Vec::new();
    rig.tick();
    rig.imus.set_implausible(1 << 3, |event| events.push(event));
    assert_eq!(events, [Event::Imu(3, SensorState::Inconsistent)]);
    let readings = rig.tick();
    assert!(readings.imu[3].is_some() && readings.events.is_empty(), "{readings:?}");
    rig.imus.set_implausible(0, |event| events.push(event));
    assert_eq!(events[1..], [Event::Imu(3, SensorState::Ok)]);
}
