//! Contact and uncertainty behind the moving-average anchor, from samples to the estimator's output.

use estimator_core::{
    ArmConfig, BendMap, BendSensorConfig, ChangeLimit, ContactConfig, ContactLimits, CoupledSegment, Coupling,
    Estimator, ImuReading, Phase, Q, QuadraticMap, Response, Sample, SegmentConfig, Turns, Uncertainty,
    UncertaintyConfig, VARIANCE_SCALE,
};

/// Deviations: of θ, of θ by bend sensors alone, and while something touches the segment, degrees.
const THETA_DEG: f64 = 0.5;
const BEND_DEG: f64 = 3.0;
const CONTACT_DEG: f64 = 2.0;

fn turns(degrees: f64) -> Turns {
    Turns::from_rad(degrees.to_radians())
}

/// The second segment bends like the first.
fn segments() -> [SegmentConfig<f64>; 2] {
    // θ = V − 1.5 rad.
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.0, 1.0, -1.5, [0.5, 2.5]));
    let sensor = Some(BendSensorConfig { map, memory: None });
    let first = SegmentConfig { bend: [sensor; 2], ..SegmentConfig::uncalibrated(0.08, 0.017) };
    [
        first,
        SegmentConfig { coupled_to: Some(CoupledSegment { segment: 0, ratio: CoupledSegment::ONE as i32 }), ..first },
    ]
}

fn table(segments: &[SegmentConfig<f64>]) -> ArmConfig<'_, f64> {
    let variance = |degrees: f64| Q::from_f64(degrees.to_radians().powi(2) * VARIANCE_SCALE);
    let rule = UncertaintyConfig {
        theta: variance(THETA_DEG),
        bias_share: Q::from_f64(1.0),
        bend: variance(BEND_DEG),
        contact: variance(CONTACT_DEG),
        heading: Q::from_f64(0.0),
        end: Q::from_f64(1e-8 * VARIANCE_SCALE),
    };
    let contact = ContactConfig { bend: turns(5.0), coupling: turns(4.0) };
    ArmConfig { contact: Some(contact), uncertainty: Some(rule), ..ArmConfig::uncalibrated(segments) }
}

/// Both sensors and IMUs of two segments at these angles, degrees.
fn sample([first, second]: [f64; 2]) -> Sample<2> {
    let counts = |degrees: f64| Some(((degrees.to_radians() + 1.5) / 3.3 * 4095.0).round() as u16);
    let heading = |degrees: f64| Some(ImuReading::Heading(Phase::from_degrees(degrees)));
    let mut sample = Sample::missing(0);
    sample.bend = [[counts(first); 2], [counts(second); 2]];
    sample.imu = [heading(first), heading(first + second)];
    sample
}

/// Standard deviation of each angle, degrees, where it is known.
fn deviations_deg(estimator: &Estimator<f64, 2, 100>) -> Vec<Option<f64>> {
    let known = estimator.uncertainties();
    known
        .iter()
        .map(|Uncertainty { theta, .. }| theta.map(|theta| (theta.to_f64() / VARIANCE_SCALE).sqrt().to_degrees()))
        .collect()
}

fn near(found: Option<f64>, expected: f64) {
    let found = found.expect("it is known");
    // A variance is rounded to a step of 2⁻²⁶ in 64 rad², 1e-6 of its deviation of half a degree.
    assert!((found - expected).abs() < 2e-5, "{found} instead of {expected}");
}

#[test]
fn a_push_on_one_of_two_alike_is_contact_of_both_within_half_a_second() {
    let segments = segments();
    let table = table(&segments);
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    for k in 0..50 {
        // Free: both swing.
        estimator.update_full(&sample([f64::from(k % 20); 2]));
        assert!(estimator.contacts().iter().all(|contact| !contact.in_contact), "value {k}");
    }
    let pushed = |k: u32| [9.0, 9.0 + 2.0 * f64::from(k)];
    let found = (1..=5).find(|k| {
        estimator.update_full(&sample(pushed(*k)));
        estimator.contacts().iter().all(|contact| contact.in_contact)
    });
    assert!(found.is_some(), "a push of 10 degrees is not detected");
}

#[test]
fn contact_widens_the_variance() {
    let segments = segments();
    let table = table(&segments);
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    for _ in 0..10 {
        estimator.update_full(&sample([5.0; 2]));
    }
    near(deviations_deg(&estimator)[1], THETA_DEG);
    estimator.update_full(&sample([5.0, 15.0]));
    near(deviations_deg(&estimator)[1], THETA_DEG.hypot(CONTACT_DEG));
}

#[test]
fn without_imu_the_variance_is_that_of_the_bend_sensors() {
    let segments = segments();
    let table = table(&segments);
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    estimator.update_full(&sample([5.0; 2]));
    estimator.update_full(&Sample { imu: [sample([5.0; 2]).imu[0], None], ..sample([5.0; 2]) });
    near(deviations_deg(&estimator)[0], THETA_DEG);
    near(deviations_deg(&estimator)[1], BEND_DEG);
}

#[test]
fn where_nothing_is_read_no_point_is_known_from_there_on() {
    let segments = segments();
    let table = table(&segments);
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    estimator.update_full(&sample([5.0; 2]));
    let whole = sample([5.0; 2]);
    estimator.update_full(&Sample { bend: [[None; 2], whole.bend[1]], imu: [None, whole.imu[1]], ..whole });
    let known = estimator.uncertainties();
    assert!(known.iter().all(|segment| segment.end.is_none()), "{known:?}");
    assert!(known[0].theta.is_none() && known[1].theta.is_some(), "{known:?}");
}

#[test]
fn a_configuration_without_thresholds_and_error_sources_gets_neither() {
    let segments = segments();
    let table = ArmConfig { contact: None, uncertainty: None, ..table(&segments) };
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    for k in 0..10 {
        estimator.update_full(&sample([5.0, 5.0 * f64::from(k)]));
    }
    assert!(estimator.uncertainties().is_empty());
    assert!(estimator.contacts().iter().all(|contact| !contact.in_contact));
}

/// The second segment bends a tenth less than the first, with limits of its own.
fn limited_segments() -> [SegmentConfig<f64>; 2] {
    let [first, second] = segments();
    let limit = ChangeLimit { change: turns(3.0), motion: turns(10.0) };
    let ratio = (0.9 * CoupledSegment::ONE) as i32;
    let coupling = Coupling { ratio_left: ratio, lead: Response::NONE, own: Response::NONE, limit };
    let contact = Some(ContactLimits { bend: None, coupling: Some(coupling) });
    [first, SegmentConfig { coupled_to: Some(CoupledSegment { segment: 0, ratio }), contact, ..second }]
}

/// Contact of each segment at the end of a swing and of a push of `pushed` values, each of which bends the second
/// segment by 1° more.
fn told_after(estimator: &mut Estimator<f64, 2, 100>, pushed: u32) -> [bool; 2] {
    for k in 0..40_u32 {
        let swing = f64::from(k.min(20));
        estimator.update_full(&sample([swing, 0.9 * swing]));
        assert!(estimator.contacts().iter().all(|contact| !contact.in_contact), "value {k}");
    }
    for k in 1..=pushed {
        estimator.update_full(&sample([20.0, 18.0 + f64::from(k)]));
    }
    let contacts = estimator.contacts();
    [contacts[0].in_contact, contacts[1].in_contact]
}

#[test]
fn a_limit_of_the_sweep_is_exceeded_in_two_values_in_a_row() {
    let segments = limited_segments();
    let table = table(&segments);
    for (pushed, expected) in [(4, false), (5, true)] {
        let mut estimator = Estimator::new(&table).expect("it fits");
        assert_eq!(told_after(&mut estimator, pushed), [expected; 2], "after {pushed}°");
    }
}
