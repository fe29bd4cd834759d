//! Wirings: their checks, and their way through an image.

use board_table::{BoardTable, ImuAddress, RegulatorWiring, SegmentWiring, TableError, Wiring, WiringError};
use calibration_tables::ArmFile;

use crate::{SEGMENTS, WINDOW, image_of, image_with, table};

/// Three segments: two bend sensors, none, one; the middle one has no IMU, the others share a channel.
fn three() -> Wiring {
    let imu = |address| Some(ImuAddress { channel: 7, address });
    let segments = [([Some(11), Some(0)], imu(0x28)), ([None, None], None), ([None, Some(5)], imu(0x29))];
    let regulators = [(40, 1_000_000), (6, 1)];
    Wiring {
        segments: segments.map(|(bend, imu)| SegmentWiring { bend, imu }).into_iter().collect(),
        regulators: regulators.map(|(pin, full_scale_pa)| RegulatorWiring { pin, full_scale_pa }).into_iter().collect(),
    }
}

/// The reference table with so many of its segments.
fn cut(segments: usize) -> ArmFile {
    let mut file = table();
    file.segments.truncate(segments);
    file
}

fn read(image: &[u8]) -> BoardTable<8> {
    let mut read = BoardTable::new();
    read.read(image, WINDOW).expect("the image is valid");
    read
}

/// The error of a wiring of three segments with one change.
fn error(change: impl Fn(&mut Wiring)) -> Option<WiringError> {
    let mut wiring = three();
    change(&mut wiring);
    wiring.check().err()
}

#[test]
fn a_wiring_is_read_back_as_it_was_written() {
    let image = image_with(&cut(3), Some(&three())).expect("it fits");
    assert_eq!(read(&image).wiring(), Some(&three()));
}

#[test]
fn a_table_without_a_wiring_has_the_reference_wiring() {
    for segments in 1..=6 {
        let image = image_of(&cut(segments));
        assert_eq!(read(&image).wiring(), Some(&Wiring::reference(segments)));
    }
}

#[test]
fn a_table_without_content_has_no_wiring() {
    let mut table = BoardTable::<SEGMENTS>::new();
    assert_eq!(table.wiring(), None);
    table.read(&image_of(&cut(3)), WINDOW).expect("the image is valid");
    table.read(b"no image", WINDOW).expect_err("it must be refused");
    assert_eq!(table.wiring(), None);
}

/// The pins of docs/how-to/wiring.md.
#[test]
fn the_reference_wiring_has_two_bend_sensors_a_segment_as_far_as_there_are_pins() {
    let wiring = Wiring::reference(8);
    let pins: Vec<_> = wiring.segments.iter().flat_map(|segment| segment.bend).collect();
    let expected: Vec<_> = (0..12).map(Some).chain([None; 4]).collect();
    assert_eq!(pins, expected);
    for (channel, segment) in (0..).zip(&wiring.segments) {
        assert_eq!(segment.imu, Some(ImuAddress { channel, address: 0x28 }));
    }
    let regulators: Vec<_> =
        wiring.regulators.iter().map(|regulator| (regulator.pin, regulator.full_scale_pa)).collect();
    assert_eq!(regulators, [6, 7, 8, 9, 34, 36].map(|pin| (pin, 280_000)));
}

#[test]
fn every_reference_wiring_passes_its_check() {
    for segments in 1..=8 {
        let wiring = Wiring::reference(segments);
        assert_eq!((wiring.check(), wiring.segments.len()), (Ok(()), segments));
    }
}

#[test]
fn an_arm_may_have_no_regulator_and_eight() {
    assert_eq!(error(|wiring| wiring.regulators.clear()), None);
    let all = board_table::REGULATOR_PINS.map(|pin| RegulatorWiring { pin, full_scale_pa: 280_000 });
    assert_eq!(error(|wiring| wiring.regulators = all.into_iter().collect()), None);
}

#[test]
fn two_bend_sensors_on_one_pin_are_refused() {
    assert_eq!(error(|wiring| wiring.segments[2].bend[0] = Some(11)), Some(WiringError::SharedAnalogPin(11)));
    assert_eq!(error(|wiring| wiring.segments[0].bend = [Some(3); 2]), Some(WiringError::SharedAnalogPin(3)));
}

#[test]
fn an_analog_pin_that_the_board_does_not_have_is_refused() {
    assert_eq!(error(|wiring| wiring.segments[1].bend[1] = Some(12)), Some(WiringError::UnknownAnalogPin(12)));
}

#[test]
fn two_imus_at_one_place_are_refused() {
    let imu = ImuAddress { channel: 7, address: 0x28 };
    let expected = WiringError::SharedImuAddress { channel: 7, address: 0x28 };
    assert_eq!(error(|wiring| wiring.segments[1].imu = Some(imu)), Some(expected));
}

#[test]
fn an_unknown_channel_or_address_is_refused() {
    for (channel, address) in [(8, 0x28), (0, 0x27), (0, 0x2A), (0, 0)] {
        let expected = WiringError::UnknownImuAddress { channel, address };
        assert_eq!(error(|wiring| wiring.segments[0].imu = Some(ImuAddress { channel, address })), Some(expected));
    }
}

#[test]
fn a_regulator_on_a_pin_without_pwm_or_on_a_pin_in_use_is_refused() {
    assert_eq!(error(|wiring| wiring.regulators[0].pin = 10), Some(WiringError::PinWithoutPwm(10)));
    assert_eq!(error(|wiring| wiring.regulators[0].pin = 6), Some(WiringError::SharedRegulatorPin(6)));
}

#[test]
fn a_full_scale_of_0_or_over_1_mpa_is_refused() {
    for full_scale_pa in [0, 1_000_001, u32::MAX] {
        let error = error(|wiring| wiring.regulators[0].full_scale_pa = full_scale_pa);
        assert_eq!(error, Some(WiringError::FullScale(40)), "{full_scale_pa} Pa");
    }
}

#[test]
fn no_segment_or_another_number_than_the_table_has_is_refused() {
    assert_eq!(error(|wiring| wiring.segments.clear()), Some(WiringError::Segments));
    let image = image_with(&cut(4), Some(&three()));
    assert_eq!(image, Err(TableError::Wiring(WiringError::Segments)));
}

#[test]
fn an_image_of_a_wrong_wiring_is_neither_written_nor_read() {
    let mut wrong = three();
    wrong.segments[1].bend[0] = Some(11);
    let expected = Err(TableError::Wiring(WiringError::SharedAnalogPin(11)));
    assert_eq!(image_with(&cut(3), Some(&wrong)), expected);
    // The row of the first segment in the image: pins 11 and 0, channel 7, address 0x28.
    let mut image = image_with(&cut(3), Some(&three())).expect("it fits");
    let row = image.windows(4).position(|bytes| bytes == [11, 0, 7, 0x28]).expect("the row");
    image[row + 1] = 11;
    assert_eq!(BoardTable::<8>::new().read(&image, WINDOW), expected.map(|_| ()));
}

#[test]
fn an_arm_of_nine_segments_has_no_image() {
    let mut file = table();
    file.segments.extend_from_within(..3);
    assert_eq!(image_with(&file, None), Err(TableError::Segments));
}
