//! Bend sensors: what reads at a rail is kept from the estimator, and only that.

use board_core::{Bends, LOSS_TICKS, RAIL_COUNTS, RETURN_TICKS};
use telemetry::{BEND_SENSORS, Event, SensorState};

const GOOD: [u16; BEND_SENSORS] = [1500, 1600, 1700, 1800, 1900, 2000, 2100, 2200, 2300, 2400, 2500, 2600];

/// The sensor 3b, which the tests break.
const BROKEN: usize = 5;

fn scan(counts: u16) -> [u16; BEND_SENSORS] {
    let mut scan = GOOD;
    scan[BROKEN] = counts;
    scan
}

/// Runs the same scan for some ticks; gives the broken sensor's counts in the last one, and what was said.
fn run(bends: &mut Bends, scan: Option<&[u16; BEND_SENSORS]>, ticks: u8) -> (Option<u16>, Vec<Event>) {
    let mut said = Vec::new();
    let mut last = None;
    for _ in 0..ticks {
        last = bends.step(scan, |event| said.push(event))[BROKEN];
    }
    (last, said)
}

#[test]
fn good_counts_pass_unchanged() {
    let mut bends = Bends::new();
    let counts = bends.step(Some(&GOOD), |event| panic!("{event:?}"));
    assert_eq!(counts, GOOD.map(Some));
    assert!(bends.health().iter().all(|health| health.state == SensorState::Ok && health.missed == 0));
}

#[test]
fn counts_at_a_rail_are_withheld_at_once_and_the_others_pass() {
    for counts in [0, RAIL_COUNTS - 1, 4096 - RAIL_COUNTS, 4095, u16::MAX] {
        let given = Bends::new().step(Some(&scan(counts)), |_| {});
        let mut expected = GOOD.map(Some);
        expected[BROKEN] = None;
        assert_eq!(given, expected, "{counts}");
    }
    for counts in [RAIL_COUNTS, 4095 - RAIL_COUNTS] {
        assert_eq!(Bends::new().step(Some(&scan(counts)), |_| {})[BROKEN], Some(counts));
    }
}

#[test]
fn a_sensor_at_a_rail_is_off_after_three_ticks_and_says_so_once() {
    let mut bends = Bends::new();
    let (_, said) = run(&mut bends, Some(&scan(4095)), LOSS_TICKS - 1);
    assert_eq!((said, bends.health()[BROKEN].state), (vec![], SensorState::Ok));
    let (_, said) = run(&mut bends, Some(&scan(4095)), 200);
    assert_eq!(said, [Event::Bend(BROKEN as u8, SensorState::Off)]);
    let off: Vec<_> = (0..BEND_SENSORS).filter(|sensor| bends.health()[*sensor].state == SensorState::Off).collect();
    assert_eq!(off, [BROKEN]);
}

#[test]
fn short_visits_to_a_rail_do_not_switch_a_sensor_off() {
    let mut bends = Bends::new();
    for _ in 0..100 {
        assert_eq!(run(&mut bends, Some(&scan(0)), LOSS_TICKS - 1), (None, vec![]));
        assert_eq!(run(&mut bends, Some(&scan(2000)), 1), (Some(2000), vec![]));
    }
}

#[test]
fn a_sensor_that_was_off_is_trusted_again_after_half_a_second_of_good_readings() {
    let mut bends = Bends::new();
    run(&mut bends, Some(&scan(0)), LOSS_TICKS);
    assert_eq!(run(&mut bends, Some(&scan(2000)), RETURN_TICKS - 1), (None, vec![]));
    // One more reading at the rail, and the count begins again.
    assert_eq!(run(&mut bends, Some(&scan(0)), 1), (None, vec![]));
    assert_eq!(run(&mut bends, Some(&scan(2000)), RETURN_TICKS - 1), (None, vec![]));
    let ok = Event::Bend(BROKEN as u8, SensorState::Ok);
    assert_eq!(run(&mut bends, Some(&scan(2000)), 1), (Some(2000), vec![ok]));
}

#[test]
fn each_tick_without_a_reading_counts_up_to_the_largest_value() {
    let mut bends = Bends::new();
    run(&mut bends, Some(&scan(0)), 1);
    run(&mut bends, Some(&scan(2000)), 1);
    run(&mut bends, Some(&scan(0)), 1);
    assert_eq!((bends.health()[BROKEN].missed, bends.health()[0].missed), (2, 0));
    for _ in 0..300 {
        run(&mut bends, None, u8::MAX);
    }
    assert!(bends.health().iter().all(|health| health.missed == u16::MAX));
}

#[test]
fn a_stale_scan_gives_nothing_and_a_stalled_converter_is_noticed() {
    let mut bends = Bends::new();
    assert_eq!(bends.step(None, |event| panic!("{event:?}")), [None; BEND_SENSORS]);
    assert_eq!(bends.step(Some(&GOOD), |event| panic!("{event:?}")), GOOD.map(Some));
    let (_, said) = run(&mut bends, None, LOSS_TICKS);
    assert_eq!(said, core::array::from_fn::<_, BEND_SENSORS, _>(|i| Event::Bend(i as u8, SensorState::Off)));
}

#[test]
fn a_segment_is_lost_with_its_last_sensor() {
    let mut bends = Bends::new();
    run(&mut bends, Some(&scan(4095)), LOSS_TICKS);
    assert!((0..6).all(|segment| !bends.segment_is_lost(segment)));
    let mut both = scan(4095);
    both[BROKEN - 1] = 0;
    run(&mut bends, Some(&both), LOSS_TICKS);
    let lost: Vec<_> = (0..6).filter(|segment| bends.segment_is_lost(*segment)).collect();
    assert_eq!(lost, [2]);
}
