//! Tares of the estimator, contact events and uncertainties.

use board_estimator::{BoardEstimator, TARE_TICKS};
use estimator_core::{
    ArmConfig, BendMap, BendSensorConfig, BiasFilterConfig, ContactConfig, Q, QuadraticMap, SegmentConfig, Turns,
    UncertaintyConfig, VARIANCE_SCALE,
};
use telemetry::{Conditions, Event, Sample};

const SEGMENTS: usize = 6;

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
        bend: [None; 2 * SEGMENTS].into_iter().collect(),
        imu: [Some([16_384, 0, 0, 0]); SEGMENTS].into_iter().collect(),
    }
}

#[test]
fn the_first_tare_waits_for_all_imus() {
    let estimator = BoardEstimator::new(table());
    assert!(!estimator.needs_first_tare(10, false));
    assert!(estimator.needs_first_tare(10, true));
}

#[test]
fn the_first_tare_waits_for_a_limited_time() {
    let estimator = BoardEstimator::new(table());
    assert!(!estimator.needs_first_tare(TARE_TICKS - 1, false));
    assert!(estimator.needs_first_tare(TARE_TICKS, false));
}

#[test]
fn there_is_one_first_tare() {
    let mut estimator = BoardEstimator::new(table());
    estimator.tare();
    assert!(!estimator.needs_first_tare(TARE_TICKS, true));
}

#[test]
fn the_tare_epoch_counts_tares() {
    let mut estimator = BoardEstimator::new(table());
    estimator.start();
    assert_eq!(estimator.tare_epoch(), 0);
    estimator.tare();
    estimator.tare();
    assert_eq!(estimator.tare_epoch(), 2);
}

#[test]
fn an_estimate_has_the_tick_of_its_sample() {
    let mut estimator = BoardEstimator::new(table());
    estimator.start();
    assert_eq!(estimator.update(&sample(77)).tick, 77);
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
    Sample {
        bend: [Some(1861); 2 * SEGMENTS].into_iter().collect(),
        imu: [Some(imu); SEGMENTS].into_iter().collect(),
        ..sample(tick)
    }
}

#[test]
fn contact_has_one_event_at_its_begin_and_one_when_a_tare_ends_it() {
    let mut estimator = BoardEstimator::new(full_table());
    estimator.start();
    let contact_after = |estimator: &mut BoardEstimator, tick, degrees| {
        estimator.update(&turned(tick, degrees));
        estimator.contact_event(tick)
    };
    assert!((0..20).all(|tick| contact_after(&mut estimator, tick, 0.0).is_none()));
    // The IMUs turn and the bend sensors do not: the first segment is in contact.
    assert_eq!(contact_after(&mut estimator, 20, 20.0), Some(Event::Contact(20, 0b1)));
    assert!((21..30).all(|tick| contact_after(&mut estimator, tick, 20.0).is_none()));
    estimator.tare();
    assert_eq!(contact_after(&mut estimator, 30, 20.0), Some(Event::Contact(30, 0)));
}

#[test]
fn an_uncertainty_is_of_the_latest_estimate() {
    let mut estimator = BoardEstimator::new(full_table());
    estimator.start();
    for tick in 0..20 {
        estimator.update(&turned(tick, 0.0));
    }
    let free = estimator.uncertainty(19);
    estimator.update(&turned(20, 20.0));
    let touched = estimator.uncertainty(20);
    assert_eq!((free.tick, touched.tick), (19, 20));
    assert!(!free.segments[0].in_contact && touched.segments[0].in_contact);
    assert!(touched.segments[0].theta > free.segments[0].theta && free.segments[0].theta.is_some());
    assert!(touched.segments[5].end.is_some());
}

#[test]
fn the_segment_that_is_bent_most_is_found_by_its_bend_sensors() {
    let mut estimator = BoardEstimator::new(full_table());
    estimator.start();
    assert_eq!(estimator.most_bent(), None);
    // θ = V − 1.5 rad: 2600 counts are 2.095 V, 1200 counts 0.967 V.
    let mut bent = turned(0, 0.0);
    for (segment, counts) in [(1, 2600), (4, 1200)] {
        bent.bend[2 * segment] = Some(counts);
        bent.bend[2 * segment + 1] = Some(counts);
    }
    estimator.update(&bent);
    let (segment, angle) = estimator.most_bent().expect("all sensors were read");
    assert_eq!(segment, 1);
    assert!((Q::from_bits(angle).to_f64() - 0.595).abs() < 0.001);
}

/// An arm whose first segment is bent, by its IMUs and bend sensors.
fn bent(tick: u32, degrees: f64) -> Sample {
    let mut sample = turned(tick, degrees);
    let counts = (1.5 + degrees.to_radians()) / 3.3 * 4095.0;
    (sample.bend[0], sample.bend[1]) = (Some(counts as u16), Some(counts as u16));
    sample
}

/// Whether the board reports that the arm was bent before a tare, which is requested at this angle.
fn is_reported_after_a_tare_at(degrees: f64) -> bool {
    let table = ArmConfig { bias_filter: Some(BiasFilterConfig::BNO055), ..*full_table() };
    let mut estimator = BoardEstimator::new(Box::leak(Box::new(table)));
    estimator.start();
    estimator.tare();
    (0..200).for_each(|tick| drop(estimator.update(&bent(tick, degrees))));
    assert!(estimator.conditions().iter().all(|of| !of.is_degraded()), "nothing was known before the first tare");
    estimator.tare();
    (200..400).for_each(|tick| drop(estimator.update(&bent(tick, degrees))));
    estimator.conditions().iter().all(|of| *of == Conditions::BENT_BEFORE_TARE)
}

#[test]
fn a_tare_of_an_arm_that_is_bent_by_its_estimate_is_reported() {
    assert!(is_reported_after_a_tare_at(10.0));
    assert!(!is_reported_after_a_tare_at(0.5));
}
