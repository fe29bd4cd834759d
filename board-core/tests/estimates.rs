//! When the estimator starts, and that it starts anew.

use board_core::{Arm, TARE_TICKS};
use estimator_core::{Q, Segment, Table};
use telemetry::{BEND_SENSORS, SEGMENTS, Sample};

/// Six segments without bend sensors, whose headings are absolute.
fn table() -> &'static Table<'static, Q> {
    let segments: &'static [Segment<Q>] = Box::leak(Box::new([Segment::bare(0.08, 0.017); SEGMENTS]));
    Box::leak(Box::new(Table::bare(segments)))
}

fn sample(tick: u32) -> Sample {
    Sample {
        tick,
        time_us: u64::from(tick) * 10_000,
        tare: 0,
        bend: [None; BEND_SENSORS],
        imu: [Some([16_384, 0, 0, 0]); SEGMENTS],
    }
}

#[test]
fn the_first_tare_waits_for_all_imus() {
    let arm = Arm::new(table());
    assert!(!arm.is_due(10, false));
    assert!(arm.is_due(10, true));
}

#[test]
fn the_first_tare_does_not_wait_for_ever() {
    let arm = Arm::new(table());
    assert!(!arm.is_due(TARE_TICKS - 1, false));
    assert!(arm.is_due(TARE_TICKS, false));
}

#[test]
fn there_is_one_first_tare() {
    let mut arm = Arm::new(table());
    arm.tare();
    assert!(!arm.is_due(TARE_TICKS, true));
}

#[test]
fn samples_can_tell_how_often_it_was_tared() {
    let mut arm = Arm::new(table());
    arm.start();
    assert_eq!(arm.tares(), 0);
    arm.tare();
    arm.tare();
    assert_eq!(arm.tares(), 2);
}

#[test]
fn an_estimate_carries_the_tick_of_its_sample() {
    let mut arm = Arm::new(table());
    arm.start();
    assert_eq!(arm.step(&sample(77)).tick, 77);
}
