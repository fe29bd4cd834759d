//! When the estimator starts, that it starts anew, and what is told beside the estimates.

use board_core::{BoardEstimator, TARE_TICKS};
use estimator_core::{
    ArmConfig, BendMap, BendSensorConfig, ContactConfig, Q, QuadraticMap, SegmentConfig, Turns, UncertaintyConfig,
    VARIANCE_SCALE,
};
use telemetry::{BEND_SENSORS, Event, SEGMENTS, Sample};

/// Six segments without bend sensors, whose headings are absolute.
fn table() -> &'static ArmConfig<'static, Q> {
    let segments: &'static [SegmentConfig<Q>] =
        Box::leak(Box::new([SegmentConfig::uncalibrated(0.08, 0.017); SEGMENTS]));
    Box::leak(Box::new(ArmConfig::uncalibrated(segments)))
}

fn sample(tick: u32) -> Sample {
    Sample {
        tick,
        time_us: u64::from(tick) * 10_000,
        tare_epoch: 0,
        bend: [None; BEND_SENSORS],
        imu: [Some([16_384, 0, 0, 0]); SEGMENTS],
    }
}

#[test]
fn the_first_tare_waits_for_all_imus() {
    let arm = BoardEstimator::new(table());
    assert!(!arm.needs_first_tare(10, false));
    assert!(arm.needs_first_tare(10, true));
}

#[test]
fn the_first_tare_does_not_wait_for_ever() {
    let arm = BoardEstimator::new(table());
    assert!(!arm.needs_first_tare(TARE_TICKS - 1, false));
    assert!(arm.needs_first_tare(TARE_TICKS, false));
}

#[test]
fn there_is_one_first_tare() {
    let mut arm = BoardEstimator::new(table());
    arm.tare();
    assert!(!arm.needs_first_tare(TARE_TICKS, true));
}

#[test]
fn samples_can_tell_how_often_it_was_tared() {
    let mut arm = BoardEstimator::new(table());
    arm.start();
    assert_eq!(arm.tare_epoch(), 0);
    arm.tare();
    arm.tare();
    assert_eq!(arm.tare_epoch(), 2);
}

#[test]
fn an_estimate_carries_the_tick_of_its_sample() {
    let mut arm = BoardEstimator::new(table());
    arm.start();
    assert_eq!(arm.update(&sample(77)).tick, 77);
}

/// Six segments with bend sensors, straight at 1.5 V, with contact detection and error sources.
fn full_table() -> &'static ArmConfig<'static, Q> {
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.0, 1.0, -1.5, [0.5, 2.5]));
    let sensor = Some(BendSensorConfig { map, memory: None });
    let segment = SegmentConfig { bend: [sensor; 2], ..SegmentConfig::uncalibrated(0.08, 0.017) };
    let segments: &'static [SegmentConfig<Q>] = Box::leak(Box::new([segment; SEGMENTS]));
    let turns = |degrees: f64| Turns::from_rad(degrees.to_radians());
    let of = |value: f64| Q::from_f64(value * VARIANCE_SCALE);
    let errors = UncertaintyConfig {
        theta: of(1e-4),
        bias_share: Q::from_f64(0.5),
        bend: of(1e-3),
        contact: of(1e-3),
        heading: of(1e-4),
        end: of(1e-6),
    };
    let contact = Some(ContactConfig { bend: turns(5.0), coupling: turns(4.0) });
    Box::leak(Box::new(ArmConfig { contact, uncertainty: Some(errors), ..ArmConfig::uncalibrated(segments) }))
}

/// All bend sensors straight, and all IMUs turned by this.
fn turned(tick: u32, degrees: f64) -> Sample {
    let half = degrees.to_radians() / 2.0;
    let imu = [half.cos(), 0.0, 0.0, half.sin()].map(|component| (component * 16384.0).round() as i16);
    Sample { bend: [Some(1861); BEND_SENSORS], imu: [Some(imu); SEGMENTS], ..sample(tick) }
}

#[test]
fn contact_is_told_once_when_it_begins_and_once_when_a_tare_ends_it() {
    let mut arm = BoardEstimator::new(full_table());
    arm.start();
    let tell = |arm: &mut BoardEstimator, tick, degrees| {
        arm.update(&turned(tick, degrees));
        arm.contact_event(tick)
    };
    assert!((0..20).all(|tick| tell(&mut arm, tick, 0.0).is_none()));
    // The IMUs turn and the bend sensors do not: the first segment is bent where they do not feel it.
    let first_alone = [true, false, false, false, false, false];
    assert_eq!(tell(&mut arm, 20, 20.0), Some(Event::Contact(20, first_alone)));
    assert!((21..30).all(|tick| tell(&mut arm, tick, 20.0).is_none()));
    arm.tare();
    assert_eq!(tell(&mut arm, 30, 20.0), Some(Event::Contact(30, [false; SEGMENTS])));
}

#[test]
fn an_uncertainty_is_of_the_newest_estimate() {
    let mut arm = BoardEstimator::new(full_table());
    arm.start();
    for tick in 0..20 {
        arm.update(&turned(tick, 0.0));
    }
    let free = arm.uncertainty(19);
    arm.update(&turned(20, 20.0));
    let touched = arm.uncertainty(20);
    assert_eq!((free.tick, touched.tick), (19, 20));
    assert!(!free.segments[0].in_contact && touched.segments[0].in_contact);
    assert!(touched.segments[0].theta > free.segments[0].theta && free.segments[0].theta.is_some());
    assert!(touched.segments[5].end.is_some());
}
