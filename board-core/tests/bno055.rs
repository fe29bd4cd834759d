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

/// SYS_STATUS … OPR_MODE; the mode's high bits are reserved.
fn state(status: u8, mode: u8) -> Transaction {
    read(0x39, &[status, 0, 0x80, 0, 0x10 | mode])
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
    let steps: [&[Transaction]; 4] =
        [&[write(0x07, 0), read(0x00, &[0xA0])], &[read(0x3D, &[0x10]), write(0x3D, 0x08)], &[], &[state(5, 8)]];
    for (tick, transactions) in (tick..).zip(steps) {
        assert_eq!(step(imu, tick, transactions), Ok(Answer::Starting));
    }
    tick + 4
}

/// An IMU that runs; its next tick is 9, in which there is no check.
fn running() -> Bno055 {
    let mut imu = Bno055::new(ADDRESS);
    start(&mut imu, 5);
    imu
}

#[test]
fn from_configmode_the_fifth_step_reads() {
    let mut imu = Bno055::new(ADDRESS);
    let tick = start(&mut imu, 5);
    assert_eq!(step(&mut imu, tick, &[quaternion([1, 2, 3, -16384])]), Ok(Answer::Quaternion([1, 2, 3, -16384])));
}

#[test]
fn a_chip_in_another_mode_is_reset_and_not_polled_for_700_ms() {
    let mut imu = Bno055::new(ADDRESS);
    assert_eq!(step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 1, &[read(0x3D, &[0x18]), write(0x3F, 0x20)]), Ok(Answer::Starting));
    for tick in 2..71 {
        assert!(imu.is_waiting(tick));
        assert_eq!(step(&mut imu, tick, &[]), Ok(Answer::Starting));
    }
    assert!(!imu.is_waiting(71));
    let tick = start(&mut imu, 71);
    assert_eq!(step(&mut imu, tick, &[quaternion(UPRIGHT)]), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_start_works_while_the_ticks_number_wraps() {
    let mut imu = Bno055::new(ADDRESS);
    let tick = u32::MAX - 1;
    assert_eq!(step(&mut imu, tick, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, tick + 1, &[read(0x3D, &[0x10]), write(0x3D, 0x08)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 0, &[]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 1, &[state(5, 8)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 2, &[quaternion(UPRIGHT)]), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_chip_that_is_gone_before_it_acknowledges_its_reset_was_reset() {
    let mut imu = Bno055::new(ADDRESS);
    let _ = step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let reset = write(0x3F, 0x20).with_error(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data));
    assert_eq!(step(&mut imu, 1, &[read(0x3D, &[0x08]), reset]), Ok(Answer::Starting));
    assert!(imu.is_waiting(2));
}

#[test]
fn a_nack_at_any_step_of_the_start_is_reported_and_the_step_repeated() {
    let steps = [
        vec![write(0x07, 0), read(0x00, &[0xA0])],
        vec![read(0x3D, &[0x10]), write(0x3D, 0x08)],
        vec![state(5, 8)],
        vec![quaternion(UPRIGHT)],
    ];
    let mut places = 0;
    for refused_step in 0..steps.len() {
        for refused in 0..steps[refused_step].len() {
            let mut imu = Bno055::new(ADDRESS);
            for (number, transactions) in (0..).zip(&steps) {
                // Far apart, so that no step waits, and odd, so that nothing is checked.
                let tick = 10 * number + 1;
                if number as usize == refused_step {
                    let mut until = transactions[..=refused].to_vec();
                    until[refused] = until[refused].clone().with_error(NACK);
                    assert_eq!(step(&mut imu, tick, &until), Err(NACK));
                    places += 1;
                }
                let mut again = transactions.clone();
                if number as usize == refused_step && refused_step == 3 {
                    again.push(state(5, 8));
                }
                assert!(step(&mut imu, tick + 2, &again).is_ok());
            }
        }
    }
    assert_eq!(places, 6);
}

#[test]
fn another_chip_at_the_address_is_invalid() {
    let mut imu = Bno055::new(ADDRESS);
    for tick in 0..3 {
        assert_eq!(step(&mut imu, tick, &[write(0x07, 0), read(0x00, &[0xE5])]), Ok(Answer::Invalid));
    }
}

#[test]
fn fusion_that_does_not_start_within_a_second_is_reset() {
    let mut imu = Bno055::new(ADDRESS);
    let _ = step(&mut imu, 0, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let _ = step(&mut imu, 1, &[read(0x3D, &[0x10]), write(0x3D, 0x08)]);
    for tick in 3..=101 {
        assert_eq!(step(&mut imu, tick, &[state(1, 8)]), Ok(Answer::Starting));
    }
    let _ = step(&mut imu, 102, &[write(0x07, 0), read(0x00, &[0xA0])]);
    let _ = step(&mut imu, 103, &[read(0x3D, &[0x18]), write(0x3F, 0x20)]);
    assert!(imu.is_waiting(104));
}

#[test]
fn mode_and_identity_are_checked_in_turn_every_80_ms() {
    let mut imu = running();
    for tick in 9..41 {
        let mut transactions = vec![quaternion(UPRIGHT)];
        match tick % 8 {
            0 => transactions.push(state(5, 8)),
            4 => transactions.push(read(0x00, &[0xA0])),
            _ => {}
        }
        assert_eq!(step(&mut imu, tick, &transactions), Ok(Answer::Quaternion(UPRIGHT)), "tick {tick}");
    }
}

#[test]
fn zeros_in_configmode_are_detected_at_once_and_the_chip_is_restarted() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 9, &[quaternion([0; 4]), state(0, 0)]), Ok(Answer::Starting));
    let tick = start(&mut imu, 10);
    assert_eq!(step(&mut imu, tick, &[quaternion(UPRIGHT)]), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_bad_norm_while_fusion_runs_is_invalid_for_that_tick() {
    let mut imu = running();
    for bad in [[0; 4], [16384, 16384, 0, 0], [i16::MIN; 4], [-1; 4], [16200, 0, 0, 0]] {
        assert_eq!(step(&mut imu, 9, &[quaternion(bad), state(5, 8)]), Ok(Answer::Invalid));
    }
    assert_eq!(step(&mut imu, 10, &[quaternion(UPRIGHT)]), Ok(Answer::Quaternion(UPRIGHT)));
}

#[test]
fn a_unit_quaternion_of_a_chip_in_another_mode_is_rejected() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 16, &[quaternion(UPRIGHT), state(6, 12)]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 17, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
}

#[test]
fn a_wrong_identity_restarts_the_chip() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 12, &[quaternion(UPRIGHT), read(0x00, &[0x00])]), Ok(Answer::Starting));
    assert_eq!(step(&mut imu, 13, &[write(0x07, 0), read(0x00, &[0xA0])]), Ok(Answer::Starting));
}

#[test]
fn after_an_error_a_reading_is_returned_only_after_a_check() {
    let mut imu = running();
    assert_eq!(step(&mut imu, 9, &[quaternion(UPRIGHT).with_error(ErrorKind::Bus)]), Err(ErrorKind::Bus));
    assert_eq!(step(&mut imu, 10, &[quaternion(UPRIGHT), state(5, 8)]), Ok(Answer::Quaternion(UPRIGHT)));
    assert_eq!(step(&mut imu, 11, &[quaternion(UPRIGHT)]), Ok(Answer::Quaternion(UPRIGHT)));
}
