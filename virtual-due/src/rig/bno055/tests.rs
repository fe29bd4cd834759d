use super::{Bno055, CONFIG, ms};
use sam3x_models::model::Cycles;

const TURNED: [i16; 4] = [13107, 0, 0, 9830];

/// Writes registers from `first` on.
fn write(unit: &mut Bno055, first: u8, bytes: &[u8], now: Cycles) {
    unit.start(false, TURNED, now);
    unit.write(first, now);
    for byte in bytes {
        unit.write(*byte, now);
    }
}

/// Reads registers from `first` on.
fn read<const COUNT: usize>(unit: &mut Bno055, first: u8, now: Cycles) -> [u8; COUNT] {
    write(unit, first, &[], now);
    unit.start(true, TURNED, now);
    std::array::from_fn(|_| unit.read())
}

/// In IMUPLUS, with output, at 1 s.
fn fusing() -> Bno055 {
    let mut unit = Bno055::powered(0);
    write(&mut unit, 0x3D, &[0x08], ms(500));
    unit
}

fn quaternion(unit: &mut Bno055, now: Cycles) -> [i16; 4] {
    let bytes: [u8; 8] = read(unit, 0x20, now);
    std::array::from_fn(|index| i16::from_le_bytes([bytes[2 * index], bytes[2 * index + 1]]))
}

#[test]
fn answers_400_ms_after_power_on_and_identifies_itself() {
    let mut unit = Bno055::powered(ms(10));
    assert!(!unit.answers(ms(410) - 1) && unit.answers(ms(410)));
    assert_eq!(read(&mut unit, 0, ms(410)), [0xA0, 0xFB, 0x32, 0x0F, 0x11, 0x03, 0x15, 0x00]);
    assert_eq!(read(&mut unit, 0x3D, ms(410)), [CONFIG]);
}

#[test]
fn data_are_zero_in_config_mode() {
    let mut unit = Bno055::powered(0);
    assert_eq!(read::<46>(&mut unit, 0x08, ms(1000)), [0; 46]);
    assert_eq!(read(&mut unit, 0x39, ms(1000)), [0]);
}

#[test]
fn mode_begins_7_ms_after_config_and_ends_19_ms_after_it_is_left() {
    let mut unit = fusing();
    assert_eq!(read(&mut unit, 0x3D, ms(507) - 1), [CONFIG]);
    assert_eq!(read(&mut unit, 0x3D, ms(507)), [0x08]);
    write(&mut unit, 0x3D, &[CONFIG], ms(1000));
    assert_eq!(read(&mut unit, 0x3D, ms(1019) - 1), [0x08]);
    assert_eq!(read(&mut unit, 0x3D, ms(1019)), [CONFIG]);
}

#[test]
fn fusion_is_not_valid_at_once() {
    let mut unit = fusing();
    assert_eq!((quaternion(&mut unit, ms(508)), read(&mut unit, 0x39, ms(508))), ([0; 4], [2]));
    assert_eq!((quaternion(&mut unit, ms(600)), read(&mut unit, 0x39, ms(600))), (TURNED, [5]));
}

#[test]
fn euler_heading_is_the_quaternions() {
    let [low, high] = read(&mut fusing(), 0x1A, ms(1000));
    let heading_deg = f64::from(u16::from_le_bytes([low, high])) / 16.0;
    assert!((heading_deg - (360.0 - 73.74)).abs() < 0.1, "{heading_deg}°");
}

#[test]
fn settings_are_writable_in_config_mode_only() {
    let mut unit = Bno055::powered(0);
    write(&mut unit, 0x55, &[1, 2, 3], ms(500));
    write(&mut unit, 0x3D, &[0x08], ms(501));
    write(&mut unit, 0x55, &[9], ms(600));
    assert_eq!(read(&mut unit, 0x55, ms(600)), [1, 2, 3]);
}

#[test]
fn page_one_has_registers_of_its_own() {
    let mut unit = Bno055::powered(0);
    write(&mut unit, 0x07, &[1], ms(500));
    assert_eq!(read(&mut unit, 0x07, ms(500)), [1, 0x0D, 0x6D, 0x38]);
    write(&mut unit, 0x07, &[0], ms(500));
    assert_eq!(read(&mut unit, 0x00, ms(500)), [0xA0]);
}

#[test]
fn system_reset_silences_it_for_650_ms_and_loses_the_settings() {
    let mut unit = fusing();
    quaternion(&mut unit, ms(1000));
    write(&mut unit, 0x3F, &[0x20], ms(1000));
    assert!(!unit.answers(ms(1650) - 1) && unit.answers(ms(1650)));
    assert_eq!(read(&mut unit, 0x3D, ms(1650)), [CONFIG]);
}

#[test]
fn brown_out_falls_back_to_config_and_the_heading_begins_at_zero() {
    let mut unit = fusing();
    assert_eq!(quaternion(&mut unit, ms(1000)), TURNED);
    unit.brown_out(ms(1000));
    assert!(unit.answers(ms(1000)));
    assert_eq!(quaternion(&mut unit, ms(1001)), [0; 4]);
    write(&mut unit, 0x3D, &[0x08], ms(1002));
    assert_eq!(quaternion(&mut unit, ms(1100)), [16384, 0, 0, 0]);
}

#[test]
fn power_that_returns_boots_it_and_its_heading_begins_at_another_zero() {
    for (silent_ms, restart) in [
        (400, Bno055::power_returns as fn(&mut Bno055, Cycles)),
        (650, Bno055::power_on_reset as fn(&mut Bno055, Cycles)),
    ] {
        let mut unit = fusing();
        assert_eq!(quaternion(&mut unit, ms(1000)), TURNED);
        restart(&mut unit, ms(1000));
        assert!(!unit.answers(ms(1000 + silent_ms) - 1) && unit.answers(ms(1000 + silent_ms)));
        assert_eq!(read(&mut unit, 0x3D, ms(1000 + silent_ms)), [CONFIG]);
        write(&mut unit, 0x3D, &[0x08], ms(1000 + silent_ms));
        assert_eq!(quaternion(&mut unit, ms(1100 + silent_ms)), [16384, 0, 0, 0]);
    }
}

#[test]
fn acceleration_is_read_without_fusion_too() {
    let mut unit = Bno055::powered(0);
    write(&mut unit, 0x3D, &[0x07], ms(500));
    // z = 9.81 m/s² in 0.01 m/s²; no magnetic field, no rate, no angle.
    let bytes: [u8; 40] = read(&mut unit, 0x08, ms(600));
    assert_eq!((&bytes[..6], &bytes[6..]), (&[0, 0, 0, 0, 0xD5, 0x03][..], &[0; 34][..]));
    assert_eq!(read(&mut unit, 0x39, ms(600)), [6]);
}
