//! Six IMUs behind the multiplexer, and their readings under faults.

use board_core::imus::ImuReadings;
use proptest::prelude::*;
use telemetry::{Event, SensorState};

mod imu_rig;
use imu_rig::{Holder, ImuRig, POWER_ON_TICKS, heading, measured, moving_tick, state, ticks_until};

/// Limit of six IMUs' time on the wire: the rest of the 6 ms is for two more, the processor and clock stretching.
const WIRE_LIMIT_US: f64 = 3_100.0;

fn none_read() -> heapless::Vec<Option<[i16; 4]>, 8> {
    [None; 6].into_iter().collect()
}

#[test]
fn imus_with_power_are_read_from_the_sixth_tick_in_order() {
    let mut rig = ImuRig::powered_up();
    for _ in 0..5 {
        assert_eq!(rig.tick(), ImuReadings { imu: none_read(), events: heapless::Vec::new() });
    }
    let readings = rig.tick();
    assert_eq!(readings.imu, [10.0, 20.0, 30.0, 40.0, 50.0, 60.0].map(|degrees| Some(heading(degrees))));
    let events: Vec<_> = (0..6).map(|k| Event::Imu(k, SensorState::Ok)).collect();
    assert_eq!(readings.events, events[..]);
    assert!(rig.imus.health().iter().all(|health| health.missed == 5));
}

#[test]
fn imus_found_running_are_reset_first_and_read_within_0_8_s() {
    let mut rig = ImuRig::powered_up();
    for chip in &mut rig.bus().chips {
        (chip.mode, chip.page) = (12, 1);
    }
    rig.ticks(80);
    assert!(rig.tick().imu.iter().all(Option::is_some));
    assert!(rig.bus().chips.iter().all(|chip| chip.mode == 8));
}

#[test]
fn no_tick_is_long_and_the_status_checks_of_different_imus_are_spread() {
    let mut rig = ImuRig::running();
    for _ in 0..100 {
        moving_tick(&mut rig);
        assert!(rig.log.len() <= 24, "{} transactions", rig.log.len());
        assert!(rig.wire_us() < WIRE_LIMIT_US, "{} µs", rig.wire_us());
    }
}

#[test]
fn imus_that_are_absent_from_the_start_leave_the_others_on_schedule() {
    for absent in 0..6 {
        let mut rig = ImuRig::powered_up();
        rig.bus().chips[absent].is_plugged = false;
        rig.ticks(5);
        let mut polls = 0;
        for _ in 0..1000 {
            let readings = moving_tick(&mut rig);
            let read: Vec<_> = readings.imu.iter().map(Option::is_some).collect();
            assert_eq!(read, (0..6).map(|k| k != absent).collect::<Vec<_>>());
            assert!(rig.wire_us() < WIRE_LIMIT_US, "{} µs", rig.wire_us());
            polls += rig.log.iter().filter(|(address, bits)| *address == 0x28 && *bits == 11).count();
        }
        assert_eq!(polls, 1000 / 25, "an absent IMU costs one address every 250 ms");
        assert_eq!(rig.imus.bus_recoveries(), 0);
    }
}

#[test]
fn an_imu_that_is_unplugged_has_no_response_within_five_ticks_and_back_when_it_answers() {
    let mut rig = ImuRig::running();
    rig.bus().chips[2].is_plugged = false;
    let readings = moving_tick(&mut rig);
    assert_eq!(readings.imu[2], None);
    assert!(ticks_until(&mut rig, 2, SensorState::NoResponse, 4) <= 4);
    rig.ticks(100);
    rig.bus().chips[2].is_plugged = true;
    assert!(ticks_until(&mut rig, 2, SensorState::Ok, 200) <= 25, "it kept running: no new start");
    assert!((0..6).filter(|k| *k != 2).all(|k| rig.imus.health()[k].missed == 5));
}

#[test]
fn a_single_nack_costs_one_reading_and_no_event() {
    let mut rig = ImuRig::running();
    rig.bus().chips[4].is_plugged = false;
    moving_tick(&mut rig);
    rig.bus().chips[4].is_plugged = true;
    let readings = moving_tick(&mut rig);
    assert!(readings.imu.iter().all(Option::is_some) && readings.events.is_empty());
    assert_eq!(rig.imus.health()[4].missed, 6);
}

#[test]
fn a_silent_brown_out_is_detected_in_the_next_tick_and_over_within_2_s() {
    for phase in 0..8 {
        for data in [None, Some(heading(77.0))] {
            let mut rig = ImuRig::running();
            rig.ticks(phase);
            // Back in CONFIGMODE, where it reads zeros or, worse, what it read last.
            rig.bus().chips[3].mode = 0;
            rig.bus().chips[3].forced = data;
            assert_eq!(ticks_until(&mut rig, 3, SensorState::NoResponse, 10), 1);
            rig.bus().chips[3].forced = None;
            ticks_until(&mut rig, 3, SensorState::Ok, 190);
            assert_eq!(rig.bus().chips[3].mode, 8);
        }
    }
}

#[test]
fn a_brown_out_in_which_the_chip_does_not_answer_is_over_within_2_s() {
    for phase in 0..25 {
        let mut rig = ImuRig::running();
        rig.ticks(phase);
        let from = rig.bus().tick + POWER_ON_TICKS;
        (rig.bus().chips[0].mode, rig.bus().chips[0].answers_from) = (0, from);
        let noticed = ticks_until(&mut rig, 0, SensorState::NoResponse, 5);
        ticks_until(&mut rig, 0, SensorState::Ok, 200 - noticed);
        assert_eq!(rig.imus.health()[1].missed, 5, "the next one missed nothing");
    }
}

#[test]
fn a_quaternion_of_wrong_norm_is_rejected_at_once_and_reported_after_three_ticks() {
    for bad in [[0; 4], [i16::MIN; 4], [16384, 16384, 16384, 16384]] {
        let mut rig = ImuRig::running();
        rig.bus().chips[1].forced = Some(bad);
        for tick in 1..=3 {
            assert_eq!(moving_tick(&mut rig).imu[1], None);
            assert_eq!(state(&rig, 1), if tick < 3 { SensorState::Ok } else { SensorState::Invalid });
        }
        rig.bus().chips[1].forced = None;
        assert!(moving_tick(&mut rig).imu[1].is_some());
    }
}

#[test]
fn an_imu_that_repeats_its_reading_while_the_others_move_is_stuck_after_half_a_second_and_until_it_moves() {
    let mut rig = ImuRig::running();
    rig.bus().chips[5].forced = Some(heading(123.0));
    moving_tick(&mut rig);
    let mut turn = 0.0;
    for tick in 1..=200 {
        turn += 0.03;
        for (k, chip) in rig.bus().chips.iter_mut().enumerate() {
            chip.quaternion = heading(10.0 * (k + 1) as f64 + turn);
        }
        let readings = rig.tick();
        assert_eq!(readings.imu[5].is_none(), tick >= 50, "tick {tick}");
        assert_eq!(readings.events.contains(&Event::Imu(5, SensorState::Stuck)), tick == 50, "tick {tick}");
        assert!((0..5).all(|k| readings.imu[k].is_some()));
    }
    rig.bus().chips[5].forced = None;
    assert!(rig.tick().imu[5].is_some());
    assert_eq!(state(&rig, 5), SensorState::Ok);
}

#[test]
fn at_rest_ten_minutes_of_the_same_bytes_are_no_fault_though_one_imu_drifts() {
    let mut rig = ImuRig::running();
    for tick in 0..60_000 {
        // 45° in 900 s, the worst drift.
        rig.bus().chips[3].quaternion = heading(40.0 + 0.0005 * f64::from(tick));
        let readings = rig.tick();
        assert!(readings.imu.iter().all(Option::is_some) && readings.events.is_empty(), "tick {tick}");
    }
}

#[test]
fn a_new_heading_after_a_start_does_not_make_resting_imus_stuck() {
    let mut rig = ImuRig::running();
    rig.ticks(120);
    rig.bus().chips[2].mode = 0;
    rig.bus().chips[2].quaternion = heading(0.0);
    for _ in 0..200 {
        rig.tick();
        assert!((0..6).filter(|k| *k != 2).all(|k| state(&rig, k) == SensorState::Ok));
    }
    assert_eq!(state(&rig, 2), SensorState::Ok);
}

#[test]
fn a_bus_clocked_free_in_the_same_tick_costs_one_reading() {
    let mut rig = ImuRig::running();
    rig.bus().holder = Some(Holder::Clockable(2));
    let readings = moving_tick(&mut rig);
    let read: Vec<_> = readings.imu.iter().map(Option::is_some).collect();
    assert_eq!(read, [true, true, false, true, true, true]);
    assert_eq!(readings.events, [Event::BusRecovery]);
    assert!(moving_tick(&mut rig).imu.iter().all(Option::is_some));
    assert_eq!(rig.imus.bus_recoveries(), 1);
}

#[test]
fn an_imu_that_keeps_holding_the_bus_is_cut_off_and_the_others_are_read() {
    let mut rig = ImuRig::running();
    rig.bus().holder = Some(Holder::Broken(0));
    for _ in 0..200 {
        let readings = moving_tick(&mut rig);
        assert!((1..6).all(|k| readings.imu[k].is_some()));
    }
    assert_eq!(state(&rig, 0), SensorState::NoResponse);
    assert!(rig.imus.bus_recoveries() <= 3 + 200 / 25);
    rig.bus().holder = None;
    ticks_until(&mut rig, 0, SensorState::Ok, 200);
}

#[test]
fn a_shorted_bus_costs_little_in_each_tick_and_is_reported_once_when_it_recovers() {
    let mut rig = ImuRig::running();
    rig.bus().holder = Some(Holder::Short);
    for tick in 1..=500 {
        let recoveries = rig.bus().recoveries;
        let readings = moving_tick(&mut rig);
        assert_eq!(readings.imu, none_read());
        assert!(rig.log.len() <= 2 && rig.bus().recoveries - recoveries <= 2, "tick {tick}: {:?}", rig.log);
        assert!(!readings.events.contains(&Event::BusRecovery));
    }
    assert!((0..6).all(|k| state(&rig, k) == SensorState::NoResponse));
    rig.bus().holder = None;
    let mut events = Vec::new();
    (0..60).for_each(|_| events.extend(moving_tick(&mut rig).events));
    assert_eq!(events.iter().filter(|event| **event == Event::BusRecovery).count(), 1);
    assert!((0..6).all(|k| state(&rig, k) == SensorState::Ok));
    assert_eq!(rig.imus.bus_recoveries(), 1);
}

#[test]
fn a_missing_multiplexer_disconnects_the_imus_until_it_returns() {
    let mut rig = ImuRig::running();
    // An earlier fault of an IMU is independent of the multiplexer's.
    rig.bus().chips[1].forced = Some([0; 4]);
    rig.tick();
    rig.bus().chips[1].forced = None;
    rig.tick();
    rig.bus().mux_is_gone = true;
    rig.ticks(3);
    assert!((0..6).all(|k| state(&rig, k) == SensorState::NoResponse));
    rig.ticks(100);
    assert!(rig.log.len() <= 4, "{:?}", rig.log);
    rig.bus().mux_is_gone = false;
    assert!(moving_tick(&mut rig).imu.iter().all(Option::is_some));
}

#[test]
fn a_multiplexer_stuck_on_a_channel_never_attributes_its_imu_to_another() {
    let mut rig = ImuRig::running();
    rig.bus().connected = 1 << 4;
    rig.bus().mux_ignores = true;
    for _ in 0..20 {
        let tick = rig.bus().tick;
        let readings = moving_tick(&mut rig);
        for (k, reading) in readings.imu.iter().enumerate() {
            assert!(reading.is_none_or(|reading| reading == measured(k, tick)), "IMU {k}");
        }
    }
    rig.bus().mux_ignores = false;
    rig.ticks(2);
    assert!(moving_tick(&mut rig).imu.iter().all(Option::is_some));
}

#[test]
fn a_multiplexer_that_confirms_a_wrong_channel_never_attributes_an_imu_to_another() {
    for channels in 1..=5 {
        let mut rig = ImuRig::running();
        rig.bus().mux_lies_by = channels;
        for _ in 0..20 {
            assert_eq!(moving_tick(&mut rig).imu, none_read(), "{channels} channels further on");
        }
        assert_eq!(state(&rig, 0), SensorState::Invalid);
        rig.bus().mux_lies_by = 0;
        // The IMUs whose channel is beyond the last one did not answer, and are polled after their pause.
        rig.ticks(25);
        assert!(moving_tick(&mut rig).imu.iter().all(Option::is_some), "no IMU was started again");
        assert!(rig.imus.health().iter().all(|imu| imu.state == SensorState::Ok));
    }
}

#[test]
fn a_tick_cut_off_at_any_transaction_keeps_the_readings_and_the_next_recovers_the_bus_first() {
    let mut whole = ImuRig::running();
    whole.tick();
    for cut in 0..whole.log.len() {
        let mut rig = ImuRig::running();
        rig.bus().hangs_at = Some(cut);
        let readings = moving_tick(&mut rig);
        let read = readings.imu.iter().filter(|reading| reading.is_some()).count();
        assert!(readings.imu[..read].iter().all(Option::is_some), "cut at {cut}");
        assert_eq!(rig.log.len(), cut + 1);

        rig.bus().hangs_at = None;
        let recoveries = rig.bus().recoveries;
        let tick = rig.bus().tick;
        let readings = moving_tick(&mut rig);
        assert_eq!(rig.bus().recoveries, recoveries + 1);
        for (k, reading) in readings.imu.iter().enumerate() {
            let expected = (k != read).then(|| measured(k, tick));
            assert_eq!(*reading, expected, "cut at {cut}, IMU {k}: only the one cut off pauses");
        }
        ticks_until(&mut rig, read, SensorState::Timeout, 3);
        ticks_until(&mut rig, read, SensorState::Ok, 25);
    }
}

#[test]
fn an_imu_that_holds_the_clock_low_delays_the_others_once_in_250_ms() {
    let mut rig = ImuRig::running();
    rig.bus().chips[1].stretches = true;
    let before = rig.imus.health()[5].missed;
    for _ in 0..250 {
        moving_tick(&mut rig);
    }
    assert_eq!(state(&rig, 1), SensorState::Timeout);
    assert_eq!(state(&rig, 5), SensorState::Ok);
    assert_eq!(rig.imus.health()[5].missed - before, 10);
}

/// A fault, for one tick or permanent.
#[derive(Debug, Clone)]
enum Fault {
    Hang(usize),
    Plug(usize, bool),
    BrownOut(usize),
    Hold(Holder),
    Release,
    MuxIgnores(bool),
    MuxLosesPower,
}

fn fault() -> impl Strategy<Value = Fault> {
    prop_oneof![
        (0_usize..25).prop_map(Fault::Hang),
        (0_usize..6, any::<bool>()).prop_map(|(k, is_plugged)| Fault::Plug(k, is_plugged)),
        (0_usize..6).prop_map(Fault::BrownOut),
        (0_usize..6).prop_map(|k| Fault::Hold(Holder::Clockable(k))),
        (0_usize..6).prop_map(|k| Fault::Hold(Holder::Broken(k))),
        Just(Fault::Hold(Holder::Short)),
        Just(Fault::Release),
        any::<bool>().prop_map(Fault::MuxIgnores),
        Just(Fault::MuxLosesPower),
    ]
}

fn inject(rig: &ImuRig, fault: &Fault) {
    let mut wiring = rig.bus();
    let tick = wiring.tick;
    match *fault {
        Fault::Hang(at) => wiring.hangs_at = Some(at),
        Fault::Plug(k, is_plugged) => wiring.chips[k].is_plugged = is_plugged,
        Fault::BrownOut(k) => {
            (wiring.chips[k].mode, wiring.chips[k].answers_from) = (0, tick + POWER_ON_TICKS);
        }
        Fault::Hold(holder) => wiring.holder = Some(holder),
        Fault::Release => wiring.holder = None,
        Fault::MuxIgnores(ignores) => wiring.mux_ignores = ignores,
        Fault::MuxLosesPower => wiring.connected = 0,
    }
}

proptest! {
    #[test]
    fn whatever_happens_no_reading_goes_under_another_name_and_all_come_back(
        faults in prop::collection::vec((fault(), 0_u32..40), 1..30)
    ) {
        let mut rig = ImuRig::running();
        for (fault, ticks) in &faults {
            inject(&rig, fault);
            for _ in 0..=*ticks {
                let tick = rig.bus().tick;
                let readings = moving_tick(&mut rig);
                rig.bus().hangs_at = None;
                for (k, reading) in readings.imu.iter().enumerate() {
                    prop_assert!(reading.is_none_or(|reading| reading == measured(k, tick)));
                }
                prop_assert!(rig.log.len() <= 36);
            }
        }
        rig.bus().holder = None;
        rig.bus().mux_ignores = false;
        rig.bus().chips.iter_mut().for_each(|chip| chip.is_plugged = true);
        (0..200).for_each(|_| { moving_tick(&mut rig); });
        prop_assert!(moving_tick(&mut rig).imu.iter().all(Option::is_some));
    }
}
