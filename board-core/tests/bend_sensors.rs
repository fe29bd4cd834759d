//! Readings of bend sensors at a rail are rejected, all others are passed on; states are debounced.

use board_core::{BendSensorMonitor, LOSS_TICKS, RAIL_COUNTS, RETURN_TICKS, Scan};
use board_table::{SegmentWiring, Wiring};
use telemetry::{Event, SensorState};

const BEND_SENSORS: usize = 12;
const OK: SensorState = SensorState::Ok;
const NOT_WIRED: SensorState = SensorState::NotWired;

const GOOD: Scan = [1500, 1600, 1700, 1800, 1900, 2000, 2100, 2200, 2300, 2400, 2500, 2600];

/// The sensor 3b, which the tests break.
const BROKEN: usize = 5;

/// Monitor of the reference wiring.
fn monitor() -> BendSensorMonitor {
    BendSensorMonitor::new(&Wiring::reference(6))
}

fn scan(counts: u16) -> Scan {
    let mut scan = GOOD;
    scan[BROKEN] = counts;
    scan
}

/// Repeats a scan for some ticks; returns the broken sensor's counts in the last one, and all events.
fn run(monitor: &mut BendSensorMonitor, scan: Option<&Scan>, ticks: u8) -> (Option<u16>, Vec<Event>) {
    let mut events = Vec::new();
    let mut last = None;
    for _ in 0..ticks {
        last = monitor.step(scan, |event| events.push(event)).get(BROKEN).copied().flatten();
    }
    (last, events)
}

#[test]
fn good_counts_pass_unchanged() {
    let mut monitor = monitor();
    let counts = monitor.step(Some(&GOOD), |event| panic!("{event:?}"));
    assert_eq!(counts, GOOD.map(Some));
    assert!(monitor.health().iter().all(|health| health.state == SensorState::Ok && health.missed == 0));
}

#[test]
fn counts_at_a_rail_are_rejected_at_once_and_the_others_pass() {
    for counts in [0, RAIL_COUNTS - 1, 4096 - RAIL_COUNTS, 4095, u16::MAX] {
        let given = monitor().step(Some(&scan(counts)), |_| {});
        let mut expected = GOOD.map(Some);
        expected[BROKEN] = None;
        assert_eq!(given, expected, "{counts}");
    }
    for counts in [RAIL_COUNTS, 4095 - RAIL_COUNTS] {
        assert_eq!(monitor().step(Some(&scan(counts)), |_| {})[BROKEN], Some(counts));
    }
}

#[test]
fn a_sensor_at_a_rail_has_no_response_after_three_ticks_and_one_event() {
    let mut monitor = monitor();
    let (_, events) = run(&mut monitor, Some(&scan(4095)), LOSS_TICKS - 1);
    assert_eq!((events, monitor.health()[BROKEN].state), (vec![], SensorState::Ok));
    let (_, events) = run(&mut monitor, Some(&scan(4095)), 200);
    assert_eq!(events, [Event::Bend(BROKEN as u8, SensorState::NoResponse)]);
    let off: Vec<_> =
        (0..BEND_SENSORS).filter(|sensor| monitor.health()[*sensor].state == SensorState::NoResponse).collect();
    assert_eq!(off, [BROKEN]);
}

#[test]
fn shorter_readings_at_a_rail_now_and_then_do_not_change_the_state() {
    let mut monitor = monitor();
    for _ in 0..100 {
        assert_eq!(run(&mut monitor, Some(&scan(0)), LOSS_TICKS - 1), (None, vec![]));
        assert_eq!(run(&mut monitor, Some(&scan(2000)), 50), (Some(2000), vec![]));
    }
}

#[test]
fn a_sensor_is_ok_again_after_half_a_second_of_good_readings() {
    let mut monitor = monitor();
    run(&mut monitor, Some(&scan(0)), LOSS_TICKS);
    assert_eq!(run(&mut monitor, Some(&scan(2000)), RETURN_TICKS - 1), (None, vec![]));
    // One more reading at the rail restarts the debounce time.
    assert_eq!(run(&mut monitor, Some(&scan(0)), 1), (None, vec![]));
    assert_eq!(run(&mut monitor, Some(&scan(2000)), RETURN_TICKS - 1), (None, vec![]));
    let ok = Event::Bend(BROKEN as u8, SensorState::Ok);
    assert_eq!(run(&mut monitor, Some(&scan(2000)), 1), (Some(2000), vec![ok]));
}

#[test]
fn ticks_without_a_reading_are_counted_and_the_count_saturates() {
    let mut monitor = monitor();
    run(&mut monitor, Some(&scan(0)), 1);
    run(&mut monitor, Some(&scan(2000)), 1);
    run(&mut monitor, Some(&scan(0)), 1);
    assert_eq!((monitor.health()[BROKEN].missed, monitor.health()[0].missed), (2, 0));
    for _ in 0..300 {
        run(&mut monitor, None, u8::MAX);
    }
    assert!(monitor.health().iter().all(|health| health.missed == u16::MAX));
}

#[test]
fn a_stale_scan_has_no_readings_and_a_stalled_converter_is_detected() {
    let mut monitor = monitor();
    assert_eq!(monitor.step(None, |event| panic!("{event:?}")), [None; BEND_SENSORS]);
    assert_eq!(monitor.step(Some(&GOOD), |event| panic!("{event:?}")), GOOD.map(Some));
    let (_, events) = run(&mut monitor, None, LOSS_TICKS);
    assert_eq!(events, core::array::from_fn::<_, BEND_SENSORS, _>(|i| Event::Bend(i as u8, SensorState::NoResponse)));
}

#[test]
fn a_sensor_that_loses_every_other_reading_is_intermittent_within_200_ms() {
    let mut monitor = monitor();
    let mut events = Vec::new();
    for _ in 0..10 {
        events.extend(run(&mut monitor, Some(&scan(0)), 1).1);
        let (read, returned) = run(&mut monitor, Some(&scan(2000)), 1);
        assert_eq!(read, Some(2000));
        events.extend(returned);
    }
    assert_eq!(events, [Event::Bend(BROKEN as u8, SensorState::Intermittent)]);
}

#[test]
fn a_sensor_is_no_longer_intermittent_after_a_second_without_a_gap() {
    let mut monitor = monitor();
    for _ in 0..50 {
        run(&mut monitor, Some(&scan(0)), 1);
        run(&mut monitor, Some(&scan(2000)), 1);
    }
    assert_eq!(run(&mut monitor, Some(&GOOD), 90).1, []);
    assert_eq!(run(&mut monitor, Some(&GOOD), 10).1, [Event::Bend(BROKEN as u8, SensorState::Ok)]);
}

#[test]
fn a_missing_reading_in_a_second_is_no_intermittent_sensor() {
    let mut monitor = monitor();
    for _ in 0..100 {
        assert_eq!(run(&mut monitor, Some(&scan(0)), 1).1, []);
        assert_eq!(run(&mut monitor, Some(&GOOD), 99).1, []);
    }
}

#[test]
fn every_other_scan_lost_makes_all_sensors_intermittent() {
    let mut monitor = monitor();
    for _ in 0..10 {
        run(&mut monitor, None, 1);
        run(&mut monitor, Some(&GOOD), 1);
    }
    assert!(monitor.health().iter().all(|health| health.state == SensorState::Intermittent));
}

#[test]
fn a_sensor_that_the_estimator_finds_implausible_is_inconsistent_at_once_and_its_counts_pass() {
    let mut monitor = monitor();
    let mut events = Vec::new();
    monitor.step(Some(&GOOD), |event| panic!("{event:?}"));
    monitor.set_implausible(1 << BROKEN, |event| events.push(event));
    assert_eq!(events, [Event::Bend(BROKEN as u8, SensorState::Inconsistent)]);
    assert_eq!(monitor.step(Some(&GOOD), |event| panic!("{event:?}")), GOOD.map(Some));
    monitor.set_implausible(0, |event| events.push(event));
    assert_eq!(events[1..], [Event::Bend(BROKEN as u8, SensorState::Ok)]);
}

#[test]
fn a_segment_is_lost_with_its_last_sensor() {
    let mut monitor = monitor();
    run(&mut monitor, Some(&scan(4095)), LOSS_TICKS);
    assert!((0..6).all(|segment| !monitor.segment_is_lost(segment)));
    let mut both = scan(4095);
    both[BROKEN - 1] = 0;
    run(&mut monitor, Some(&both), LOSS_TICKS);
    let lost: Vec<_> = (0..6).filter(|segment| monitor.segment_is_lost(*segment)).collect();
    assert_eq!(lost, [2]);
}

#[test]
fn each_place_reads_its_own_pin_and_a_place_without_a_sensor_is_no_fault() {
    let mut wiring = Wiring::reference(3);
    let bend = [[Some(11), None], [None, None], [Some(0), Some(5)]];
    for (SegmentWiring { bend: pins, .. }, bend) in wiring.segments.iter_mut().zip(bend) {
        *pins = bend;
    }
    let mut monitor = BendSensorMonitor::new(&wiring);
    // All other pins are open.
    let mut scan = [4095; BEND_SENSORS];
    (scan[11], scan[0], scan[5]) = (1111, 1000, 1005);
    for _ in 0..200 {
        let counts = monitor.step(Some(&scan), |event| panic!("{event:?}"));
        assert_eq!(counts, [Some(1111), None, None, None, Some(1000), Some(1005)]);
    }
    let states: Vec<_> = monitor.health().iter().map(|health| health.state).collect();
    assert_eq!(states, [OK, NOT_WIRED, NOT_WIRED, NOT_WIRED, OK, OK]);
    assert!(monitor.health().iter().all(|health| health.missed == 0));
    assert!((0..3).all(|segment| !monitor.segment_is_lost(segment)));
}

#[test]
fn a_segment_with_one_sensor_is_lost_with_that_sensor() {
    let mut wiring = Wiring::reference(2);
    wiring.segments[1].bend = [None, Some(3)];
    let mut monitor = BendSensorMonitor::new(&wiring);
    let mut scan = GOOD;
    scan[3] = 0;
    run(&mut monitor, Some(&scan), LOSS_TICKS - 1);
    assert!(!monitor.segment_is_lost(1));
    run(&mut monitor, Some(&scan), 1);
    assert!(monitor.segment_is_lost(1) && !monitor.segment_is_lost(0));
}
