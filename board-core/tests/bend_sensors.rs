//! Readings of bend sensors at a rail are rejected, all others are passed on; states are debounced.

use board_core::{BendSensorMonitor, LOSS_TICKS, RAIL_COUNTS, RETURN_TICKS};
use telemetry::{BEND_SENSORS, Event, SensorState};

const GOOD: [u16; BEND_SENSORS] = [1500, 1600, 1700, 1800, 1900, 2000, 2100, 2200, 2300, 2400, 2500, 2600];

/// The sensor 3b, which the tests break.
const BROKEN: usize = 5;

fn scan(counts: u16) -> [u16; BEND_SENSORS] {
    let mut scan = GOOD;
    scan[BROKEN] = counts;
    scan
}

/// Repeats a scan for some ticks; returns the broken sensor's counts in the last one, and all events.
fn run(monitor: &mut BendSensorMonitor, scan: Option<&[u16; BEND_SENSORS]>, ticks: u8) -> (Option<u16>, Vec<Event>) {
    let mut events = Vec::new();
    let mut last = None;
    for _ in 0..ticks {
        last = monitor.step(scan, |event| events.push(event))[BROKEN];
    }
    (last, events)
}

#[test]
fn good_counts_pass_unchanged() {
    let mut monitor = BendSensorMonitor::new();
    let counts = monitor.step(Some(&GOOD), |event| panic!("{event:?}"));
    assert_eq!(counts, GOOD.map(Some));
    assert!(monitor.health().iter().all(|health| health.state == SensorState::Ok && health.missed == 0));
}

#[test]
fn counts_at_a_rail_are_rejected_at_once_and_the_others_pass() {
    for counts in [0, RAIL_COUNTS - 1, 4096 - RAIL_COUNTS, 4095, u16::MAX] {
        let given = BendSensorMonitor::new().step(Some(&scan(counts)), |_| {});
        let mut expected = GOOD.map(Some);
        expected[BROKEN] = None;
        assert_eq!(given, expected, "{counts}");
    }
    for counts in [RAIL_COUNTS, 4095 - RAIL_COUNTS] {
        assert_eq!(BendSensorMonitor::new().step(Some(&scan(counts)), |_| {})[BROKEN], Some(counts));
    }
}

#[test]
fn a_sensor_at_a_rail_has_no_response_after_three_ticks_and_one_event() {
    let mut monitor = BendSensorMonitor::new();
    let (_, events) = run(&mut monitor, Some(&scan(4095)), LOSS_TICKS - 1);
    assert_eq!((events, monitor.health()[BROKEN].state), (vec![], SensorState::Ok));
    let (_, events) = run(&mut monitor, Some(&scan(4095)), 200);
    assert_eq!(events, [Event::Bend(BROKEN as u8, SensorState::NoResponse)]);
    let off: Vec<_> =
        (0..BEND_SENSORS).filter(|sensor| monitor.health()[*sensor].state == SensorState::NoResponse).collect();
    assert_eq!(off, [BROKEN]);
}

#[test]
fn shorter_readings_at_a_rail_do_not_change_the_state() {
    let mut monitor = BendSensorMonitor::new();
    for _ in 0..100 {
        assert_eq!(run(&mut monitor, Some(&scan(0)), LOSS_TICKS - 1), (None, vec![]));
        assert_eq!(run(&mut monitor, Some(&scan(2000)), 1), (Some(2000), vec![]));
    }
}

#[test]
fn a_sensor_is_ok_again_after_half_a_second_of_good_readings() {
    let mut monitor = BendSensorMonitor::new();
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
    let mut monitor = BendSensorMonitor::new();
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
    let mut monitor = BendSensorMonitor::new();
    assert_eq!(monitor.step(None, |event| panic!("{event:?}")), [None; BEND_SENSORS]);
    assert_eq!(monitor.step(Some(&GOOD), |event| panic!("{event:?}")), GOOD.map(Some));
    let (_, events) = run(&mut monitor, None, LOSS_TICKS);
    assert_eq!(events, core::array::from_fn::<_, BEND_SENSORS, _>(|i| Event::Bend(i as u8, SensorState::NoResponse)));
}

#[test]
fn a_segment_is_lost_with_its_last_sensor() {
    let mut monitor = BendSensorMonitor::new();
    run(&mut monitor, Some(&scan(4095)), LOSS_TICKS);
    assert!((0..6).all(|segment| !monitor.segment_is_lost(segment)));
    let mut both = scan(4095);
    both[BROKEN - 1] = 0;
    run(&mut monitor, Some(&both), LOSS_TICKS);
    let lost: Vec<_> = (0..6).filter(|segment| monitor.segment_is_lost(*segment)).collect();
    assert_eq!(lost, [2]);
}
