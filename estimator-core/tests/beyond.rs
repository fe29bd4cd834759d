//! Contact and uncertainty, from samples to what the estimator says of them.

use estimator_core::{
    AnchorConfig, ArmConfig, BendMap, BiasFilterConfig, ContactConfig, CoupledSegment, Estimate, Estimator, ImuReading,
    Phase, Sample, SegmentConfig, SegmentEstimate, Turns, Uncertainty, UncertaintyConfig, VARIANCE_SCALE,
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
    let map = Some(BendMap::from_volts(0.0, 1.0, -1.5, [0.5, 2.5]));
    let first = SegmentConfig { bend: [map, map], ..SegmentConfig::uncalibrated(0.08, 0.017) };
    [first, SegmentConfig { alike: Some(CoupledSegment { segment: 0, ratio: CoupledSegment::ONE as i32 }), ..first }]
}

fn table(segments: &[SegmentConfig<f64>]) -> ArmConfig<'_, f64> {
    let variance = |degrees: f64| degrees.to_radians().powi(2) * VARIANCE_SCALE;
    let rule = UncertaintyConfig {
        theta: variance(THETA_DEG),
        drift: 0.0,
        bend: variance(BEND_DEG),
        contact: variance(CONTACT_DEG),
        heading: 0.0,
        end: 1e-8 * VARIANCE_SCALE,
    };
    let contact = ContactConfig { bend: turns(5.0), alike: turns(4.0) };
    ArmConfig { contact: Some(contact), uncertainty: Some(rule), ..ArmConfig::uncalibrated(segments) }
}

/// An observer of values at 10 Hz.
fn observer() -> BiasFilterConfig {
    let one = f64::from(1 << 30);
    BiasFilterConfig {
        step: (4_294_967_296.0 / (10.0 * BiasFilterConfig::RATE_S)) as u32,
        prior: [(1e-3 * one) as i32, (1e-2 * one) as i32, 1],
        growth: [0, 35, 1],
        gate: turns(8.0),
        patience: 300,
        jump: turns(12.0),
        still: turns(1.0),
        doubt: 1 << 23,
    }
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
        .map(|Uncertainty { theta, .. }| theta.map(|theta| (theta / VARIANCE_SCALE).sqrt().to_degrees()))
        .collect()
}

fn near(found: Option<f64>, expected: f64) {
    let found = found.expect("it is known");
    assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
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
    assert!(found.is_some(), "10 degrees of push are none");
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
fn the_variance_grows_while_saturated_bend_sensors_leave_the_observer_alone() {
    let segments = segments();
    let rule = UncertaintyConfig { drift: 1.0, ..table(&segments).uncertainty.expect("it has one") };
    let table = ArmConfig { observer: Some(observer()), uncertainty: Some(rule), ..table(&segments) };
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    for k in 0..600 {
        estimator.update_full(&sample([30.0 * (f64::from(k) / 12.0).sin(); 2]));
    }
    let before = deviations_deg(&estimator)[0].expect("it is known");
    for k in 0..600 {
        let whole = sample([30.0 * (f64::from(k) / 12.0).sin(); 2]);
        estimator.update_full(&Sample { bend: [[None; 2]; 2], ..whole });
    }
    let after = deviations_deg(&estimator)[0].expect("it is known");
    assert!(after > 1.2 * before, "{before} and then {after} degrees");
}

#[test]
fn a_table_that_does_not_ask_gets_neither() {
    let segments = segments();
    let table = ArmConfig { contact: None, uncertainty: None, ..table(&segments) };
    let mut estimator = Estimator::<_, 2, 100>::new(&table).expect("it fits");
    for k in 0..10 {
        estimator.update_full(&sample([5.0, 5.0 * f64::from(k)]));
    }
    assert!(estimator.uncertainties().is_empty());
    assert!(estimator.contacts().iter().all(|contact| !contact.in_contact));
}

/// What the observer takes from each θ_imu, degrees.
fn biases_deg(estimate: &Estimate<f64, 2>) -> Vec<f64> {
    let of_segment = |segment: &SegmentEstimate<f64>| Some(segment.imu_o?.rad() - segment.imu_c?.theta.rad());
    estimate.segments.iter().filter_map(of_segment).map(f64::to_degrees).collect()
}

#[test]
fn ten_samples_a_value_teach_each_segment_what_one_does() {
    let segments = segments();
    let at_10_hz = ArmConfig { observer: Some(observer()), ..table(&segments) };
    let at_100_hz =
        ArmConfig { anchor: AnchorConfig { sample_rate_millihertz: 100_000, ..at_10_hz.anchor }, ..at_10_hz };
    let [mut slow, mut fast] =
        [&at_10_hz, &at_100_hz].map(|table| Estimator::<_, 2, 100>::new(table).expect("it fits"));
    let mut taught: Vec<f64> = Vec::new();
    for k in 0..600 {
        // The first IMU drifts by 30° in the minute.
        let (bend, drift) = (30.0 * (f64::from(k) / 12.0).sin(), 0.05 * f64::from(k));
        let sample = Sample { imu: sample([bend + drift, bend - drift]).imu, ..sample([bend; 2]) };
        let estimates: Vec<_> = (0..10).map(|_| fast.step(&sample)).collect();
        // Before its value is complete, all segments have had their turn with the one before.
        for (fast, slow) in biases_deg(&estimates[8]).iter().zip(&taught) {
            assert!((fast - slow).abs() < 1e-9, "{fast} instead of {slow} degrees");
        }
        taught = biases_deg(&slow.step(&sample));
    }
    assert!(taught[0] > 15.0 && taught[1] < -15.0, "{taught:?}");
}
