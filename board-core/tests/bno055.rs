//! The BNO055's transactions, one by one.

use board_core::bno055::{ADDRESS, Answer, Bno055};
use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};

mod imu_rig;
use imu_rig::now;

const NACK: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
const UPRIGHT: [i16; 4] = [16384, 0, 0, 0];

fn write(register: u8, value: u8) -> Transaction {
    Transaction::write(ADDRESS, vec![register, value])
}

fn read(register: u8, bytes: &[u8]) -> Transaction {
    Transaction::write_read(ADDRESS, vec![register], bytes.to_vec())
}

fn quaternion(components: [i16; 4]) -> Transaction {
    read(0x20, &components.map(i16::to_le_bytes).concat())
}

/// The mark of the IMU, and UNIT_SEL with it.
const MARK: u8 = 9;
const UNITS: u8 = 0x91;

fn imu() -> Bno055 {
    Bno055::new(ADDRESS, MARK)
}

/// SYS_STATUS … OPR_MODE; the mode's high bits are reserved.
fn state(status: u8, mode: u8) -> Transaction {
    read(0x39, &[status, 0, UNITS, 0, 0x10 | mode])
}

/// UNIT_SEL … OPR_MODE.
fn mark_and_mode(units: u8, mode: u8) -> Transaction {
    read(0x3B, &[units, 0, 0x10 | mode])
}

/// A reading of the IMU itself while fusion runs, but for the ticks in which the status is checked.
fn reading(components: [i16; 4]) -> [Transaction; 2] {
    [quaternion(components), mark_and_mode(UNITS, 8)]
}

/// One step with exactly these transactions.
fn step(imu: &mut Bno055, tick: u32, transactions: &[Transaction]) -> Result<Answer, ErrorKind> {
    let mut i2c = Mock::new(transactions);
    let answer = now(imu.step(&mut i2c, tick));
    i2c.done();
    answer
}

/// The steps from CONFIGMODE to the first reading, and the tick of that.
fn start(imu: &mut Bno055, tick: u32) -> u32 {
    let steps: [&[Transaction]; 5] = [
        &[write(0x07, 0), read(0x00, &[0xA0])],
        &[read(0x3D, &[0x10]), write(0x3B, UNITS)],
        &[write(0x3D, 0x08)],
        &[],
        &[state(5, 8)],
    ];
    for (tick, transactions) in (tick..).zip(steps) {
        assert_eq!(step(imu, tick, transactions), Ok(Answer::Starting));
    }
    tick + 5
}

/// An IMU that runs; its next tick is 9, in which the status is not checked.
fn running() -> Bno055 {
    let mut imu = imu();
    start(&mut imu, 4);
    imu
}

#[test]
fn from_configmode_the_sixth_step_reads() {
    let mut imu = imu();
    let tick = start(&mut imu, 5);
    assert_eq!(step(&mut imu, tick, &reading([1, 2, 3, -16384])), Ok(Answer::Quaternion([1, 2, 3, -16384])));
}

#[test]
fn a_chip_in_another_mode_is_reset_and_not_polled_for_700_ms() {
    let mut imu = imu();
    assert_eq!(step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 1, &[read(0x3D, &[0x18]), write(0x3F, 0x20)]), Ok(Answer::Starting));
    for tick in 2..71 {
        assert!(imu.is_waiting(tick));
        assert_eq!(step(&mut imu, tick, &[]), Ok(Answer::Starting));
    }
    assert!(!imu.is_waiting(71));
    let tick = start(&mut imu, 71);
    assert_eq!(step(&mut imu, tick, &reading(UPRIGHT)), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_start_works_while_the_ticks_number_wraps() {
    let mut imu = imu();
    let tick = u32::MAX - 2;
    assert_eq!(step(&mut imu, tick, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, tick + 1, &[read(0x3D, &[0x10]), write(0x3B, UNITS)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, tick + 2, &[write(0x3D, 0x08)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 0, &[]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 1, &[state(5, 8)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 2, &reading(UPRIGHT)), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_chip_that_is_gone_before_it_acknowledges_its_reset_was_reset() {
    let mut imu = imu();
    let _ = step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let reset = write(0x3F, 0x20).with_error(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data));
    assert_eq!(step(&mut imu, 1, &[read(0x3D, &[0x08]), reset]), Ok(Answer::Starting));
    assert!(imu.is_waiting(2));
}

#[test]
fn a_nack_at_any_step_of_the_start_is_reported_and_the_step_repeated() {
    let steps = [
        vec![write(0x07, 0), read(0x00, &[0xA0])],
        vec![read(0x3D, &[0x10]), write(0x3B, UNITS)],
        vec![write(0x3D, 0x08)],
        vec![state(5, 8)],
        reading(UPRIGHT).to_vec(),
    ];
    let mut places = 0;
    for refused_step in 0..steps.len() {
        for refused in 0..steps[refused_step].len() {
            let mut imu = imu();
            for (number, transactions) in (0..).zip(&steps) {
                // Far apart, so that no step waits, and odd, so that the status is not checked.
                let tick = 10 * number + 1;
                if number as usize == refused_step {
                    let mut until = transactions[..=refused].to_vec();
                    until[refused] = until[refused].clone().with_error(NACK);
                    assert_eq!(step(&mut imu, tick, &until), Err(NACK));
                    places += 1;
                }
                assert!(step(&mut imu, tick + 2, transactions).is_ok());
            }
        }
    }
    assert_eq!(places, 8);
}

#[test]
fn another_chip_at_the_address_is_invalid() {
    let mut imu = imu();
    for tick in 0..3 {
        assert_eq!(step(&mut imu, tick, &[write(0x07, 0), read(0x00, &[0xE5])]), Ok(Answer::Invalid));
    }
}

#[test]
fn fusion_that_does_not_start_within_a_second_is_reset() {
    let mut imu = imu();
    let _ = step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let _ = step(&mut imu, 1, &[read(0x3D, &[0x10]), write(0x3B, UNITS)]);
    let _ = step(&mut imu, 2, &[write(0x3D, 0x08)]);
    for tick in 4..=102 {
        assert_eq!(step(&mut imu, tick, &[state(1, 8)]), Ok(Answer::Starting));
    }
    let _ = step(&mut imu, 103, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let _ = step(&mut imu, 104, &[read(0x3D, &[0x18]), write(0x3F, 0x20)]);
    assert!(imu.is_waiting(105));
}

#[test]
fn mark_and_mode_are_read_with_each_reading_and_the_status_every_80_ms() {
    let mut imu = running();
    for tick in 9..41 {
        let check = if tick % 8 == 0 { state(5, 8) } else { mark_and_mode(UNITS, 8) };
        assert_eq!(step(&mut imu, tick, &[quaternion(UPRIGHT), check]), Ok(Answer::Quaternion(UPRIGHT)), "tick {tick}");
    }
}

#[test]
fn each_mark_of_an_arm_is_another_and_leaves_the_reserved_bits() {
    let mut marks: Vec<u8> = Vec::new();
    for mark in 1..=8 {
        let mut imu = Bno055::new(ADDRESS, mark);
        let _ = step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]);
        let units = 0x80 | [0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x10][usize::from(mark) - 1];
        let _ = step(&mut imu, 1, &[read(0x3D, &[0x10]), write(0x3B, units)]);
        marks.push(units);
    }
    marks.sort_unstable();
    marks.dedup();
    assert!(marks.len() == 8 && !marks.contains(&0x80));
}

#[test]
fn the_reading_of_another_imu_is_invalid_and_its_chip_is_left_as_it_is() {
    let mut imu = running();
    for _ in 0..3 {
        assert_eq!(step(&mut imu, 9, &[quaternion(UPRIGHT), mark_and_mode(0x82, 8)]), Ok(Answer::Invalid));
    }
    assert_eq!(step(&mut imu, 10, &reading(UPRIGHT)), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_chip_that_does_not_keep_its_mark_is_read() {
    let mut imu = imu();
    let _ = step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let _ = step(&mut imu, 1, &[read(0x3D, &[0x10]), write(0x3B, UNITS)]);
    let _ = step(&mut imu, 2, &[write(0x3D, 0x08)]);
    let _ = step(&mut imu, 4, &[read(0x39, &[5, 0, 0x80, 0, 0x18])]);
    let reading = [quaternion(UPRIGHT), mark_and_mode(0x80, 8)];
    assert_eq!(step(&mut imu, 5, &reading), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn zeros_in_configmode_are_detected_at_once_and_the_chip_is_restarted() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 9, &[quaternion([0; 4]), mark_and_mode(0x80, 0)]), Ok(Answer::Starting));
    let tick = start(&mut imu, 10);
    assert_eq!(step(&mut imu, tick, &reading(UPRIGHT)), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_bad_norm_while_fusion_runs_is_invalid_for_that_tick() {
    let mut imu = running();
    for bad in [[0; 4], [16384, 16384, 0, 0], [i16::MIN; 4], [-1; 4], [16200, 0, 0, 0]] {
        assert_eq!(step(&mut imu, 9, &reading(bad)), Ok(Answer::Invalid));
    }
    assert_eq!(step(&mut imu, 10, &reading(UPRIGHT)), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_unit_quaternion_of_a_chip_in_another_mode_is_rejected() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 9, &[quaternion(UPRIGHT), mark_and_mode(UNITS, 12)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 10, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
}

#[test]
fn a_chip_whose_fusion_has_ended_is_restarted() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 16, &[quaternion(UPRIGHT), state(1, 8)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 17, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
}

#[test]
fn an_error_costs_one_reading() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 9, &[quaternion(UPRIGHT).with_error(ErrorKind::Bus)]), Err(ErrorKind::Bus));
    assert_eq!(step(&mut imu, 10, &reading(UPRIGHT)), Ok(Answer::Quaternion(UPRIGHT)));
}
