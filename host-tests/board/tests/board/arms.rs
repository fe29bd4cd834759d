//! The same firmware with arms of 1 to 8 segments and any wiring.

use board_table::{ImuAddress, RegulatorWiring, SegmentWiring, Wiring};
use board_tests::{Board, WiredArm};
use estimator_core::Q;
use rig_twin::{MotionProgram, Scenario, Setup};
use telemetry::{Command, Refusal, RequestOutcome, SensorState, SetPressures};

use crate::replay::assert_replays_of;

/// One segment with one bend sensor on A11 and an IMU at 0x29 of channel 6, two regulators of 100 kPa.
fn one_segment() -> WiredArm {
    let imu = Some(ImuAddress { channel: 6, address: 0x29 });
    let regulator = |pin| RegulatorWiring { pin, full_scale_pa: 100_000 };
    WiredArm::new(Wiring {
        segments: [SegmentWiring { bend: [Some(11), None], imu }].into_iter().collect(),
        regulators: [regulator(40), regulator(6)].into_iter().collect(),
    })
}

/// Three segments of which the second has no IMU and the third no bend sensor; two IMUs on one channel; no regulator.
fn three_segments() -> WiredArm {
    let imu = |address| Some(ImuAddress { channel: 2, address });
    let segments = [
        SegmentWiring { bend: [Some(7), Some(3)], imu: imu(0x29) },
        SegmentWiring { bend: [Some(0), None], imu: None },
        SegmentWiring { bend: [None, None], imu: imu(0x28) },
    ];
    WiredArm::new(Wiring { segments: segments.into_iter().collect(), regulators: heapless::Vec::new() })
}

/// Eight segments on all twelve pins, and eight regulators.
fn eight_segments() -> WiredArm {
    let mut wiring = Wiring::reference(8);
    for (k, segment) in wiring.segments.iter_mut().enumerate() {
        let k = k as u8;
        segment.bend = if k < 4 { [Some(2 * k), Some(2 * k + 1)] } else { [Some(k + 4), None] };
    }
    wiring.regulators =
        board_table::REGULATOR_PINS.map(|pin| RegulatorWiring { pin, full_scale_pa: 280_000 }).into_iter().collect();
    WiredArm::new(wiring)
}

fn running(arm: &WiredArm) -> Board {
    let mut board = arm.board(Scenario::FreeSwing, 3);
    board.run_ms(4000);
    board
}

#[test]
fn the_board_says_how_many_segments_sensors_and_regulators_it_has() {
    for (arm, counts) in [(one_segment(), (1, 1, 2)), (three_segments(), (3, 3, 0)), (eight_segments(), (8, 12, 8))] {
        let mut board = arm.board(Scenario::FreeSwing, 3);
        board.run_ms(300);
        let hello = board.hellos().next().expect("it introduces itself");
        assert_eq!((hello.segments, hello.bend_sensors, hello.regulators), counts);
        assert_eq!(hello.arm, arm.file.arm.as_str());
    }
}

#[test]
fn all_wired_sensors_are_read_and_the_others_are_no_fault() {
    for arm in [one_segment(), three_segments(), eight_segments()] {
        let board = running(&arm);
        let health = board.healths().next_back().expect("it comes at 5 Hz");
        let sample = board.samples().next_back().expect("it comes at 100 Hz");
        let wiring = arm.file.board.as_ref().expect("it has a wiring");
        assert_eq!(sample.imu.len(), wiring.segments.len());
        assert_eq!(sample.bend.len(), 2 * wiring.segments.len());
        for (i, segment) in wiring.segments.iter().enumerate() {
            let state = |is_wired| if is_wired { SensorState::Ok } else { SensorState::NotWired };
            assert_eq!(health.imu[i].state, state(segment.imu.is_some()), "imu{}", i + 1);
            assert_eq!(sample.imu[i].is_some(), segment.imu.is_some(), "imu{}", i + 1);
            for place in 0..2 {
                let is_wired = place < segment.bend.len();
                assert_eq!(health.bend[2 * i + place].state, state(is_wired), "bend{}, {place}", i + 1);
                assert_eq!(sample.bend[2 * i + place].is_some(), is_wired, "bend{}, {place}", i + 1);
            }
        }
    }
}

#[test]
fn every_estimate_of_one_three_and_eight_segments_is_the_hosts() {
    for arm in [one_segment(), three_segments(), eight_segments()] {
        assert_replays_of(&arm.file, &running(&arm), 0);
    }
}

#[test]
fn eight_segments_are_estimated_every_second_tick_and_the_line_has_room_to_spare() {
    let mut board = running(&eight_segments());
    let (samples, estimates, bytes) = (board.samples().count(), board.estimates().count(), board.bytes());
    board.run_ms(5000);
    let (samples, estimates) = (board.samples().count() - samples, board.estimates().count() - estimates);
    assert!((498..=502).contains(&samples) && (249..=251).contains(&estimates), "{samples}, {estimates}");
    assert!(board.bytes() - bytes <= 5 * 20_000, "{} bytes in 5 s", board.bytes() - bytes);
    let health = board.healths().next_back().expect("it comes at 5 Hz");
    assert_eq!((health.overruns, health.dropped_frames), (0, 0));
    assert!(health.load_permille < 250, "{} ‰", health.load_permille);
}

#[test]
fn eight_segments_move_by_their_eight_regulators_and_every_estimate_is_the_hosts() {
    let arm = eight_segments();
    let mut board = running(&arm);
    let layout = rig_twin::Layout::of_file(&arm.file).expect("eight segments");
    board.swing(&MotionProgram::of(&Setup { layout, ..Setup::new(Scenario::FreeSwing, 3) }), 12);
    assert_replays_of(&arm.file, &board, 0);
    let tip =
        |estimate: &telemetry::Estimate| Q::from_bits(estimate.segments[7].as_ref().expect("known").end[0]).to_f64();
    let (low, high) = board.estimates().skip(200).map(tip).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
    assert!(high - low > 0.1, "the tip moved by {} m", high - low);
}

#[test]
fn an_arm_without_imus_is_driven() {
    let mut wiring = Wiring::reference(2);
    wiring.segments.iter_mut().for_each(|segment| segment.imu = None);
    let mut board = running(&WiredArm::new(wiring));
    let pressures_pa = [100_000; 6].into_iter().collect();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    let set = Command::SetPressures(SetPressures { pressures_pa, valid_ms: 500 });
    assert_eq!(board.request(set), RequestOutcome::Ack);
    let commanded = board.machine.world().set_points_pa();
    assert!(commanded.iter().all(|found| (found - 100_000.0).abs() <= 67.0), "{commanded:?}");
}

#[test]
fn set_points_go_to_the_wired_pins_in_the_regulators_own_scale() {
    let mut board = running(&one_segment());
    let set = |pressures_pa: &[u32]| {
        Command::SetPressures(SetPressures { pressures_pa: pressures_pa.iter().copied().collect(), valid_ms: 500 })
    };
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    assert_eq!(board.request(set(&[50_000, 100_000])), RequestOutcome::Ack);
    let commanded = board.machine.world().set_points_pa();
    for (found, expected) in commanded.iter().zip([50_000.0, 100_000.0]) {
        // A step of the PWM is 24 Pa.
        assert!((found - expected).abs() <= 24.0, "{commanded:?}");
    }
    assert_eq!(board.request(set(&[100_001, 0])), RequestOutcome::Nack(Refusal::OverRange));
    assert_eq!(board.request(set(&[0])), RequestOutcome::Nack(Refusal::Regulators));
    assert_eq!(board.request(set(&[0; 6])), RequestOutcome::Nack(Refusal::Regulators));
}
