#![expect(clippy::float_cmp, reason = "set-points are exact")]

use super::WiredRig;
use super::pins::{MUX_RESET, SCL, SDA};
use rig_twin::Scenario;
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles, I2c, Pin, World};

const SECOND: Cycles = CYCLES_PER_SECOND;
/// PC24.
const D6: Pin = Pin { port: 2, line: 24 };

/// Begins a fault.
fn inject(rig: &mut WiredRig, fault: &str) {
    rig.inject(fault.parse().expect("a fault")).expect("the arm has the sensor");
}

/// Ends a fault.
fn clear(rig: &mut WiredRig, fault: &str) {
    rig.clear(fault.parse().expect("a fault"));
}

fn rig() -> WiredRig {
    WiredRig::new(Scenario::FreeSwing, 7)
}

/// Connects these channels.
fn select(rig: &mut WiredRig, channels: u8, now: Cycles) -> bool {
    let acknowledged = rig.start(0x70, false, now) && rig.write(channels, now);
    rig.stop(now);
    acknowledged
}

/// Reads registers of the units connected at 0x28.
fn registers<const COUNT: usize>(rig: &mut WiredRig, first: u8, now: Cycles) -> Option<[u8; COUNT]> {
    let acknowledged = rig.start(0x28, false, now) && rig.write(first, now) && rig.start(0x28, true, now);
    let bytes = std::array::from_fn(|_| I2c::read(rig, now));
    rig.stop(now);
    acknowledged.then_some(bytes)
}

/// All six in IMUPLUS, with output, at 1 s.
fn fusing() -> WiredRig {
    let mut rig = rig();
    let now = SECOND / 2;
    select(&mut rig, 0x3F, now);
    assert!(rig.start(0x28, false, now) && rig.write(0x3D, now) && rig.write(0x08, now));
    rig.stop(now);
    rig
}

/// The quaternion of one unit.
fn quaternion(rig: &mut WiredRig, imu: usize, now: Cycles) -> Option<[i16; 4]> {
    assert!(select(rig, 1 << imu, now));
    let bytes = registers::<8>(rig, 0x20, now)?;
    Some(std::array::from_fn(|index| i16::from_le_bytes([bytes[2 * index], bytes[2 * index + 1]])))
}

#[test]
fn each_bend_sensor_is_on_its_channel() {
    let mut rig = rig();
    let counts = rig_twin::Rig::new(Scenario::FreeSwing, 7).adc_counts();
    for (channel, expected) in [7, 6, 5, 4, 3, 2, 1, 0, 10, 11, 12, 13].into_iter().zip(counts) {
        assert_eq!(Some(rig.adc_counts(channel, 0)), expected, "channel {channel}");
    }
}

#[test]
fn broken_bend_sensor_lies_at_a_rail() {
    let mut rig = rig();
    inject(&mut rig, "bend1a:open");
    inject(&mut rig, "bend6b:short");
    assert_eq!((rig.adc_counts(7, 0), rig.adc_counts(13, 0)), (4095, 0));
}

#[test]
fn arm_moves_by_its_program_until_a_regulator_pin_is_used() {
    let mut rig = rig();
    rig.advance_to(12 * SECOND);
    assert!(rig.set_points_pa().iter().any(|pressure| *pressure > 1000.0));
    rig.pwm(7, Some((210, 420)), 12 * SECOND);
    assert_eq!(rig.set_points_pa()[..], [140_000.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    rig.pwm(7, None, 12 * SECOND);
    assert_eq!(rig.set_points_pa()[..], [0.0; 6]);
}

#[test]
fn pin_driven_high_is_full_scale_and_bends_the_arm_clockwise() {
    let mut rig = rig();
    rig.drive(D6, Some(true), 0);
    assert_eq!(rig.set_points_pa()[0], 280_000.0);
    rig.advance_to(3 * SECOND);
    assert!(rig.truth()[1].heading_rad > 0.5, "{} rad", rig.truth()[1].heading_rad);
}

#[test]
fn arm_is_the_same_however_often_it_is_advanced() {
    let (mut often, mut once) = (rig(), rig());
    for ms in 0..8000 {
        often.advance_to(ms * SECOND / 1000);
    }
    once.advance_to(7999 * SECOND / 1000);
    assert_eq!(often.truth(), once.truth());
    assert_ne!(once.truth(), rig().truth());
}

#[test]
fn each_imu_is_on_its_channel() {
    let mut rig = fusing();
    let now = 8 * SECOND;
    let expected = {
        rig.advance_to(now);
        rig.twin().imu_quaternions()
    };
    for (imu, expected) in expected.into_iter().enumerate() {
        assert_eq!(quaternion(&mut rig, imu, now), expected, "IMU {}", imu + 1);
    }
}

#[test]
fn two_channels_at_once_give_the_and_of_both() {
    let mut rig = fusing();
    let [first, second] = [0, 1].map(|imu| quaternion(&mut rig, imu, SECOND).expect("it is there"));
    select(&mut rig, 0b11, SECOND);
    let both = registers::<2>(&mut rig, 0x20, SECOND).map(i16::from_le_bytes);
    assert_eq!(both, Some(first[0] & second[0]));
}

#[test]
fn unplugged_imu_does_not_answer_and_boots_when_it_is_back() {
    let mut rig = fusing();
    inject(&mut rig, "imu3:unplugged");
    assert_eq!(quaternion(&mut rig, 2, SECOND), None);
    assert!(quaternion(&mut rig, 3, SECOND).is_some());
    rig.advance_to(2 * SECOND);
    clear(&mut rig, "imu3:unplugged");
    assert_eq!(quaternion(&mut rig, 2, 2 * SECOND), None);
    assert_eq!(quaternion(&mut rig, 2, 2 * SECOND + 2 * SECOND / 5), Some([0; 4]), "it is in CONFIG");
}

#[test]
fn frozen_imu_keeps_showing_the_same() {
    let mut rig = fusing();
    let before = quaternion(&mut rig, 5, SECOND);
    inject(&mut rig, "imu6:frozen");
    assert_eq!(quaternion(&mut rig, 5, 20 * SECOND), before);
    clear(&mut rig, "imu6:frozen");
    assert_ne!(quaternion(&mut rig, 5, 20 * SECOND + SECOND / 100), before);
}

#[test]
fn browned_out_imu_reads_as_zero() {
    let mut rig = fusing();
    assert_ne!(quaternion(&mut rig, 0, SECOND), Some([0; 4]));
    inject(&mut rig, "imu1:brown-out");
    assert_eq!(quaternion(&mut rig, 0, SECOND), Some([0; 4]));
}

#[test]
fn reset_pin_ends_what_is_wrong_with_the_mux() {
    let mut rig = rig();
    assert!(select(&mut rig, 1, SECOND));
    inject(&mut rig, "mux:silent");
    assert!(!select(&mut rig, 2, SECOND));
    rig.drive(MUX_RESET, Some(false), SECOND);
    assert!(!select(&mut rig, 2, SECOND), "it is in reset");
    rig.drive(MUX_RESET, Some(true), SECOND);
    assert_eq!(registers::<1>(&mut rig, 0, SECOND), None, "no channel is connected");
    assert!(select(&mut rig, 2, SECOND));
    assert_eq!(registers(&mut rig, 0, SECOND), Some([0xA0]));
}

#[test]
fn data_line_is_freed_by_clock_pulses() {
    let mut rig = rig();
    inject(&mut rig, "sda:held-clocks=9");
    for pulse in 0..9 {
        assert_eq!(rig.level(SDA, 0), Some(false), "after {pulse} pulses");
        rig.drive(SCL, Some(false), 0);
        rig.drive(SCL, None, 0);
    }
    assert_eq!((rig.level(SDA, 0), rig.held(0)), (Some(true), (false, false)));
}

#[test]
fn stop_condition_by_hand_ends_a_transfer() {
    let mut rig = rig();
    rig.start(0x70, false, SECOND);
    rig.write(1, SECOND);
    rig.drive(SDA, Some(false), SECOND);
    rig.drive(SDA, None, SECOND);
    assert_eq!(registers(&mut rig, 0, SECOND), Some([0xA0]));
}

#[test]
fn no_device_is_on_the_other_bus() {
    let mut rig = rig();
    assert!(!rig.i2c(0).start(0x70, false, SECOND));
    assert!(rig.i2c(1).start(0x70, false, SECOND));
}
