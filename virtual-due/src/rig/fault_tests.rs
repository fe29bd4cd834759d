use super::WiredRig;
use rig_twin::{FaultError, Layout, Scenario, Setup};
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles, I2c, World};

const SECOND: Cycles = CYCLES_PER_SECOND;

fn with(fault: &str) -> WiredRig {
    let mut rig = WiredRig::new(Scenario::FreeSwing, 7);
    rig.advance_to(SECOND);
    rig.inject(fault.parse().expect("a fault")).expect("the arm has the sensor");
    rig
}

/// Connects the IMU of segment 3, and calls it.
fn call(rig: &mut WiredRig, now: Cycles) -> bool {
    assert!(rig.start(0x70, false, now) && rig.write(0b100, now));
    rig.stop(now);
    let is_there = rig.start(0x28, true, now);
    rig.stop(now);
    is_there
}

#[test]
fn an_imu_that_resets_does_not_answer_for_650_ms() {
    let mut rig = with("imu3:reset");
    assert!(!call(&mut rig, SECOND) && !call(&mut rig, SECOND + 649 * SECOND / 1000));
    assert!(call(&mut rig, SECOND + 650 * SECOND / 1000));
}

#[test]
fn nacks_come_in_their_share() {
    let mut rig = with("imu3:nack=0.25");
    let refused = (0..4000).filter(|_| !call(&mut rig, SECOND)).count();
    assert!((900..1100).contains(&refused), "{refused} of 4000");
}

#[test]
fn a_stretched_clock_is_held_before_a_transfer_to_the_master() {
    let mut rig = with("imu3:stretch=2");
    call(&mut rig, SECOND);
    rig.start(0x28, true, SECOND);
    assert_eq!((rig.stretch(SECOND), rig.stretch(SECOND)), (SECOND / 500, 0));
}

#[test]
fn tags_are_wrong_in_every_scan_or_in_every_second() {
    let mut rig = with("adc:tags");
    assert_eq!((rig.adc_tag(7), rig.adc_tag(15)), (8, 0));
    let mut rig = with("adc:tags-every-other");
    let tags = [3, 7, 3, 7, 3, 7].map(|channel| {
        rig.adc_counts(channel, SECOND);
        rig.adc_tag(channel)
    });
    assert!(tags == [3, 7, 4, 8, 3, 7] || tags == [4, 8, 3, 7, 4, 8], "{tags:?}");
}

#[test]
fn a_stopped_converter_runs_again_when_the_fault_ends() {
    let mut rig = with("adc:stopped");
    assert!(rig.adc_is_stopped());
    rig.clear("adc:stopped".parse().expect("a fault"));
    assert!(!rig.adc_is_stopped());
}

#[test]
fn sensors_that_the_arm_does_not_have_are_refused() {
    let layout = Layout::uniform(2).expect("two segments");
    let setup = Setup { layout, ..Setup::new(Scenario::FreeSwing, 1) };
    let mut rig = WiredRig::of(&setup, &board_table::Wiring::reference(2));
    for fault in ["imu3:nack=0.5", "imu3:reset", "bend3a:open"] {
        let error = rig.inject(fault.parse().expect("a fault"));
        assert_eq!(error, Err(FaultError::NotOnArm(fault.to_owned())));
    }
}
