//! Wirings other than the reference one, at the pins and on the bus.
#![expect(clippy::float_cmp, reason = "set-points are exact")]

use super::WiredRig;
use board_table::{ImuAddress, RegulatorWiring, SegmentWiring, Wiring};
use rig_twin::{Layout, Scenario, SegmentLayout, Setup};
use sam3x_models::model::{CYCLES_PER_SECOND, Cycles, I2c, Pin, World};

const SECOND: Cycles = CYCLES_PER_SECOND;
/// The ADC channel of each analog pin (datasheet table 43-2, schematic of the Due).
const CHANNELS: [u8; 12] = [7, 6, 5, 4, 3, 2, 1, 0, 10, 11, 12, 13];

fn setup(segments: usize) -> Setup {
    Setup { layout: Layout::uniform(segments).expect("1 to 8 segments"), ..Setup::new(Scenario::FreeSwing, 7) }
}

fn segment(bend: [Option<u8>; 2], imu: Option<(u8, u8)>) -> SegmentWiring {
    SegmentWiring { bend, imu: imu.map(|(channel, address)| ImuAddress { channel, address }) }
}

fn wiring(segments: &[SegmentWiring], regulators: &[(u8, u32)]) -> Wiring {
    let regulators = regulators.iter().map(|&(pin, full_scale_pa)| RegulatorWiring { pin, full_scale_pa });
    let wiring = Wiring { segments: segments.iter().copied().collect(), regulators: regulators.collect() };
    wiring.check().expect("the wiring is valid");
    wiring
}

/// An arm of three segments whose sensors are on any pins, under four regulators.
fn three() -> WiredRig {
    let segments = [
        segment([Some(11), None], Some((7, 0x29))),
        segment([None, Some(0)], Some((2, 0x28))),
        segment([Some(5), Some(8)], Some((2, 0x29))),
    ];
    WiredRig::of(&setup(3), &wiring(&segments, &[(40, 280_000), (38, 280_000), (9, 100_000), (6, 1_000_000)]))
}

/// Connects these channels of the multiplexer.
fn select(rig: &mut WiredRig, channels: u8, now: Cycles) {
    assert!(rig.start(0x70, false, now) && rig.write(channels, now));
    rig.stop(now);
}

/// The quaternion of the unit at `address` on the connected channels.
fn quaternion(rig: &mut WiredRig, address: u8, now: Cycles) -> Option<[i16; 4]> {
    let acknowledged = rig.start(address, false, now) && rig.write(0x20, now) && rig.start(address, true, now);
    let bytes: [u8; 8] = std::array::from_fn(|_| I2c::read(rig, now));
    rig.stop(now);
    acknowledged.then(|| std::array::from_fn(|index| i16::from_le_bytes([bytes[2 * index], bytes[2 * index + 1]])))
}

/// Sets the units at both addresses of all channels to IMUPLUS.
fn begin_fusion(rig: &mut WiredRig, now: Cycles) {
    select(rig, 0xFF, now);
    for address in [0x28, 0x29] {
        assert!(rig.start(address, false, now) && rig.write(0x3D, now) && rig.write(0x08, now));
        rig.stop(now);
    }
}

#[test]
fn each_bend_sensor_is_on_its_pin_and_other_pins_are_grounded() {
    let mut rig = three();
    let mut twin = rig.twin().clone();
    let wired = [(11, 0), (0, 3), (5, 4), (8, 5)];
    for (pin, sensor) in wired {
        assert_eq!(Some(rig.adc_counts(CHANNELS[pin], 0)), twin.convert(sensor), "A{pin}");
    }
    for pin in (0..12).filter(|pin| !wired.iter().any(|(wired, _)| wired == pin)) {
        assert_eq!(rig.adc_counts(CHANNELS[pin], 0), 0, "A{pin}");
    }
}

#[test]
fn every_analog_pin_can_carry_a_bend_sensor() {
    for pin in 0..12 {
        let mut rig = WiredRig::of(&setup(1), &wiring(&[segment([None, Some(pin)], None)], &[]));
        let expected = rig.twin().clone().convert(1);
        assert_eq!(Some(rig.adc_counts(CHANNELS[usize::from(pin)], 0)), expected, "A{pin}");
    }
}

#[test]
fn a_scan_counts_at_the_first_bend_sensor_that_is_wired() {
    let mut rig = three();
    rig.adc_counts(CHANNELS[0], 0);
    assert_eq!(rig.last_scan().0, 0);
    rig.adc_counts(CHANNELS[11], 0);
    assert_eq!(rig.last_scan(), (1, rig.truth()));
}

#[test]
fn each_imu_is_at_its_address_on_its_channel_and_no_other() {
    let mut rig = three();
    begin_fusion(&mut rig, SECOND / 2);
    rig.advance_to(8 * SECOND);
    let orientations = rig.twin().imu_quaternions();
    let wired = [(7, 0x29), (2, 0x28), (2, 0x29)];
    for (place, orientation) in wired.into_iter().zip(orientations) {
        let (channel, address) = place;
        select(&mut rig, 1 << channel, 8 * SECOND);
        assert_eq!(quaternion(&mut rig, address, 8 * SECOND), orientation, "channel {channel}, {address:#x}");
    }
    for (channel, address) in (0..8).flat_map(|channel| [(channel, 0x28), (channel, 0x29)]) {
        select(&mut rig, 1 << channel, 8 * SECOND);
        let is_there = quaternion(&mut rig, address, 8 * SECOND).is_some();
        assert_eq!(is_there, wired.contains(&(channel, address)), "channel {channel}, {address:#x}");
    }
}

#[test]
fn each_pwm_channel_and_each_line_drives_the_regulator_of_its_pin() {
    let pins = [(6, 7, 24), (7, 6, 23), (8, 5, 22), (9, 4, 21), (34, 0, 2), (36, 1, 4), (38, 2, 6), (40, 3, 8)];
    let regulators = pins.map(|(pin, ..)| (pin, 280_000));
    for (regulator, (pin, channel, line)) in pins.into_iter().enumerate() {
        let mut rig = WiredRig::of(
            &setup(8),
            &Wiring { segments: Wiring::reference(8).segments, ..wiring(&[segment([None; 2], None)], &regulators) },
        );
        let mut expected = [0.0; 8];
        rig.pwm(channel, Some((105, 420)), 0);
        expected[regulator] = 70_000.0;
        assert_eq!(rig.set_points_pa()[..], expected, "D{pin}");
        rig.pwm(channel, None, 0);
        // A line of PIOC.
        rig.drive(Pin { port: 2, line }, Some(true), 0);
        expected[regulator] = 280_000.0;
        assert_eq!(rig.set_points_pa()[..], expected, "D{pin}");
    }
}

#[test]
fn set_points_are_in_the_order_and_of_the_full_scale_of_the_wiring() {
    let mut rig = three();
    for channel in [3, 2, 4, 7] {
        rig.pwm(channel, Some((210, 420)), 0);
    }
    assert_eq!(rig.set_points_pa()[..], [140_000.0, 140_000.0, 50_000.0, 500_000.0]);
}

/// Heading of the first segment's end in rad after 5 s of half the duty on D40, a regulator of this full scale.
fn heading_rad(full_scale_pa: u32) -> f64 {
    let mut rig = WiredRig::of(&setup(1), &wiring(&[segment([None; 2], None)], &[(40, full_scale_pa)]));
    rig.pwm(3, Some((210, 420)), 0);
    rig.advance_to(5 * SECOND);
    rig.truth()[0].heading_rad
}

#[test]
fn the_arm_bends_by_the_pressure_of_the_full_scale_as_far_as_the_supply_has_it() {
    let [low, half, supply, above] = [100_000, 280_000, 560_000, 1_000_000].map(heading_rad);
    assert!(low > 0.1 && half > 2.0 * low && supply > 1.5 * half, "{low}, {half}, {supply} rad");
    assert_eq!(above, supply);
}

#[test]
fn regulators_beyond_the_arms_modules_move_nothing() {
    let mut rig = WiredRig::of(&setup(2), &Wiring::reference(2));
    rig.pwm(5, Some((420, 420)), 0);
    rig.advance_to(3 * SECOND);
    assert_eq!((rig.set_points_pa()[2], rig.truth()[1].heading_rad), (280_000.0, 0.0));
}

#[test]
fn an_arm_without_regulators_moves_by_its_program() {
    let mut rig = WiredRig::of(&setup(3), &wiring(&[segment([Some(0), None], None); 1], &[]));
    rig.advance_to(12 * SECOND);
    assert!(rig.truth()[2].heading_rad.abs() > 0.01, "{} rad", rig.truth()[2].heading_rad);
    assert!(rig.set_points_pa().is_empty());
}

#[test]
fn sensors_that_the_arm_does_not_have_are_not_there() {
    let bare = SegmentLayout { bend: [true, false], imu: false, ..setup(1).layout.segments()[0] };
    let setup = Setup { layout: Layout::new(&[bare]).expect("valid lengths"), ..setup(1) };
    let mut rig = WiredRig::of(&setup, &Wiring::reference(2));
    assert_eq!(rig.wiring().segments[..], [segment([Some(0), None], None)]);
    assert_eq!(rig.adc_counts(CHANNELS[1], 0), 0);
    select(&mut rig, 1, SECOND);
    assert_eq!(quaternion(&mut rig, 0x28, SECOND), None);
}
