//! The whole pipeline, one sample in and one estimate out.

use estimator_core::{
    AnchorConfig, Angle, ArmConfig, BendMap, BendSensorConfig, BiasFilterConfig, ConfigError, Estimate, Estimator,
    FusedOps, ImuReading, KalmanParams, Method, Phase, Q, QuadraticMap, Sample, Scalar, SegmentConfig, Turns,
};
use proptest::prelude::*;

const LSB: f64 = 1.0 / 67_108_864.0;

/// θ = V − 1.5 rad.
fn sensor<S: FusedOps>() -> BendSensorConfig<S> {
    BendSensorConfig { map: quadratic(0.0, 1.0, -1.5, [0.5, 2.5]), memory: None }
}

fn quadratic<S: FusedOps>(c2: f64, c1: f64, c0: f64, volts: [f64; 2]) -> BendMap<S> {
    BendMap::Quadratic(QuadraticMap::from_volts(c2, c1, c0, volts))
}

/// Counts of such a sensor at the bend angle `theta`, rounded to a count (0.8 mrad).
fn counts(theta: f64) -> u16 {
    ((theta + 1.5) / 3.3 * 4095.0).round() as u16
}

/// Bend angle of such a sensor at these counts, rad.
fn bent(counts: u16) -> f64 {
    f64::from(counts) * 3.3 / 4095.0 - 1.5
}

fn segment<S: FusedOps>(sensors: usize) -> SegmentConfig<S> {
    let noise = KalmanParams {
        q: S::from_f64(0.5),
        r_imu: S::from_f64(0.25),
        r_bend: S::one(),
        h_imu: S::one(),
        h_bend: S::one(),
    };
    let map = |k| (k < sensors).then(sensor);
    SegmentConfig { bend: [map(0), map(1)], orient: noise, coord: noise, ..SegmentConfig::uncalibrated(0.08, 0.017) }
}

fn rule(window: u16) -> AnchorConfig {
    AnchorConfig { window, rate_millihertz: 10_000, sample_rate_millihertz: 10_000, threshold: Turns::from_rad(0.01) }
}

fn table<S>(segments: &[SegmentConfig<S>]) -> ArmConfig<'_, S> {
    ArmConfig { anchor: rule(10), ..ArmConfig::uncalibrated(segments) }
}

fn heading(rad: f64) -> ImuReading {
    ImuReading::Heading(Phase::from_rad(rad))
}

/// All segments bent by the same angle, by all sensors.
fn sample<const N: usize>(theta: f64) -> Sample<N> {
    let mut sample = Sample::missing(0);
    for i in 0..N {
        sample.bend[i] = [Some(counts(theta)); 2];
        sample.imu[i] = Some(heading(theta * (i + 1) as f64));
    }
    sample
}

/// Availability of each segment's θ by a method.
fn is_known<const N: usize>(
    estimator: &Estimator<f64, N, 10>,
    estimate: &Estimate<f64, N>,
    method: Method,
) -> Vec<bool> {
    estimator.shape(estimate, method).iter().map(|segment| segment.theta.is_some()).collect()
}

fn rad<S: Scalar>(angle: Option<Angle<S>>) -> f64 {
    angle.expect("an angle").rad()
}

proptest! {
    #[test]
    fn with_the_bias_filter_the_room_for_segments_does_not_change_a_bit(
        thetas in prop::collection::vec(-1.0..1.0, 1..50),
    ) {
        let segments = [segment::<Q>(2); 6];
        let table = ArmConfig { bias_filter: Some(BiasFilterConfig::BNO055), ..table(&segments) };
        let mut six = Estimator::<Q, 6, 10>::new(&table).expect("a valid table");
        let mut sixteen = Estimator::<Q, 16, 100>::new(&table).expect("a valid table");
        for (k, theta) in thetas.into_iter().enumerate() {
            let time_us = k as u64 * 100_000;
            let small = six.update_full(&Sample { time_us, ..sample(theta) });
            let large = sixteen.update_full(&Sample { time_us, ..sample(theta) });
            prop_assert_eq!(&small.segments[..], &large.segments[..]);
        }
    }

    #[test]
    fn the_room_for_segments_does_not_change_a_bit(thetas in prop::collection::vec(-1.0..1.0, 1..50)) {
        let segments = [segment::<Q>(2); 6];
        let table = table(&segments);
        let mut six = Estimator::<Q, 6, 10>::new(&table).expect("a valid table");
        let mut sixteen = Estimator::<Q, 16, 100>::new(&table).expect("a valid table");
        for theta in thetas {
            let (small, large) = (six.update_full(&sample(theta)), sixteen.update_full(&sample(theta)));
            prop_assert_eq!(&small.segments[..], &large.segments[..]);
            for method in Method::ALL {
                prop_assert_eq!(&six.shape(&small, method)[..], &sixteen.shape(&large, method)[..]);
            }
        }
    }

    #[test]
    fn the_bend_angle_is_the_mean_of_the_sensors_that_were_read(
        a in prop::option::of(0_u16..=4095),
        b in prop::option::of(0_u16..=4095),
    ) {
        let segments = [segment::<f64>(2)];
        let table = table(&segments);
        let mut estimator = Estimator::<f64, 1, 10>::new(&table).expect("a valid table");
        let mut sample = Sample::missing(0);
        sample.bend[0] = [a, b];
        let estimate = estimator.update_full(&sample).segments[0];
        let read: Vec<_> = [a, b].into_iter().flatten().map(bent).collect();
        prop_assert_eq!(usize::from(estimate.bend_sensors_read), read.len());
        let expected = (!read.is_empty()).then(|| read.iter().sum::<f64>() / read.len() as f64);
        prop_assert_eq!(estimate.bend.is_some(), expected.is_some());
        if let (Some(link), Some(expected)) = (estimate.bend, expected) {
            // V up to 53 at 65 535 counts, in floats.
            prop_assert!((link.theta.rad() - expected).abs() < 1e-12);
        }
    }
}

#[test]
fn a_missing_imu_leaves_two_angles_unknown_for_that_sample_only() {
    let segments = [segment::<f64>(2); 4];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 4, 10>::new(&table).expect("a valid table");
    let mut without = sample(0.3);
    without.imu[1] = None;
    for (sample, known) in [(sample(0.2), [true; 4]), (without, [true, false, false, true]), (sample(0.4), [true; 4])] {
        let estimate = estimator.update_full(&sample);
        assert_eq!(is_known(&estimator, &estimate, Method::ImuO), known);
        assert_eq!(is_known(&estimator, &estimate, Method::ImuC), known);
        assert_eq!(is_known(&estimator, &estimate, Method::Bend), [true; 4]);
        assert_eq!(is_known(&estimator, &estimate, Method::Fusion), [true; 4]);
        let read: Vec<_> = estimate.segments.iter().map(|segment| segment.imu_read).collect();
        assert_eq!(read, sample.imu.map(|imu| imu.is_some()));
    }
}

#[test]
fn a_segment_with_the_second_sensor_alone_reads_that() {
    let segments = [SegmentConfig { bend: [None, Some(sensor())], ..segment::<f64>(0) }];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 1, 10>::new(&table).expect("a valid table");
    let mut sample = Sample::missing(0);
    sample.bend[0] = [Some(counts(-1.0)), Some(counts(0.5))];
    let estimate = estimator.update_full(&sample).segments[0];
    assert!((rad(estimate.bend.map(|link| link.theta)) - bent(counts(0.5))).abs() < 1e-12);
    assert_eq!(estimate.bend_sensors_read, 1);
}

#[test]
fn a_rejected_quaternion_is_a_missing_reading() {
    let segments = [segment::<f64>(2); 2];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 2, 10>::new(&table).expect("a valid table");
    let mut zeroed = sample(0.3);
    zeroed.imu[1] = Some(ImuReading::from_bno055([0; 4]));
    let estimate = estimator.update_full(&zeroed);
    assert_eq!(is_known(&estimator, &estimate, Method::ImuO), [true, false]);
    assert!(!estimate.segments[1].imu_read);
}

#[test]
fn the_imus_angle_is_the_difference_of_neighbouring_headings() {
    let segments = [segment::<f64>(2); 3];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 3, 10>::new(&table).expect("a valid table");
    let mut sample = Sample::missing(0);
    sample.imu = [0.5, -0.25, 1.0].map(|rad| Some(heading(rad)));
    let angles = estimator.update_full(&sample).segments.iter().map(|segment| rad(segment.imu_o)).collect::<Vec<_>>();
    for (angle, expected) in angles.iter().zip([0.5, -0.75, 1.25]) {
        assert!((angle - expected).abs() < 2e-9, "{angle} instead of {expected}: a unit of 2⁻³² turns is 1.5e-9");
    }
}

#[test]
fn imus_are_silent_until_the_last_sample_of_the_tare() {
    let segments = [segment::<f64>(2); 2];
    let table = ArmConfig { tare_samples: 3, ..table(&segments) };
    let mut estimator = Estimator::<f64, 2, 10>::new(&table).expect("a valid table");
    for known in [false, false, true, true] {
        let estimate = estimator.update_full(&sample(0.1));
        assert_eq!(is_known(&estimator, &estimate, Method::ImuO), [known; 2]);
        assert_eq!(is_known(&estimator, &estimate, Method::ImuC), [known; 2]);
        assert_eq!(is_known(&estimator, &estimate, Method::Bend), [true; 2]);
        assert_eq!(is_known(&estimator, &estimate, Method::Fusion), [true; 2]);
    }
}

/// θ_c of one segment at these bend and IMU angles, held for the whole window.
fn corrected(threshold: Turns, bend: f64, imu: f64) -> f64 {
    let segments = [segment::<f64>(1)];
    let table = ArmConfig { anchor: AnchorConfig { threshold, ..rule(10) }, ..table(&segments) };
    let mut estimator = Estimator::<f64, 1, 10>::new(&table).expect("a valid table");
    let mut sample = Sample::missing(0);
    (sample.bend[0][0], sample.imu[0]) = (Some(counts(bend)), Some(heading(imu)));
    rad(estimator.update_full(&sample).segments[0].imu_c.map(|link| link.theta))
}

#[test]
fn an_offset_beyond_the_threshold_is_taken_out() {
    assert!((corrected(Turns::from_rad(0.01), 0.2, 0.5) - bent(counts(0.2))).abs() < 2e-9);
    assert!((corrected(Turns::from_rad(0.01), 0.2, -0.5) - bent(counts(0.2))).abs() < 2e-9);
}

#[test]
fn an_offset_up_to_the_threshold_is_left_alone() {
    assert!((corrected(Turns::from_rad(0.4), 0.2, 0.5) - 0.5).abs() < 2e-9);
    let offset = Turns::from_rad(0.5) - Turns::from_rad(bent(counts(0.2)));
    assert!((corrected(offset, 0.2, 0.5) - 0.5).abs() < 2e-9, "> and not ≥");
    assert!((corrected(offset - Turns::from_bits(1), 0.2, 0.5) - bent(counts(0.2))).abs() < 2e-9);
}

#[test]
fn a_segment_without_bend_sensors_has_its_raw_imus_and_a_fusion_of_them() {
    let segments = [segment::<f64>(1), segment(0)];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 2, 10>::new(&table).expect("a valid table");
    let mut drifted = sample(0.2);
    drifted.imu = [0.5, 1.2].map(|rad| Some(heading(rad)));
    let estimate = estimator.update_full(&drifted);
    assert_eq!(is_known(&estimator, &estimate, Method::Bend), [true, false]);
    let bare = estimate.segments[1];
    assert_eq!(bare.bend_sensors_read, 0);
    for angle in [bare.imu_o, bare.imu_c.map(|link| link.theta), bare.fusion.map(|fused| fused.theta)] {
        assert!((rad(angle) - 0.7).abs() < 3e-9);
    }
    let anchored = estimate.segments[0].imu_c.map(|link| link.theta);
    assert!((rad(anchored) - bent(counts(0.2))).abs() < 2e-9);
}

#[test]
fn a_table_without_bend_sensors_says_imu_o_alone() {
    let segments = [segment::<f64>(0); 2];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 2, 10>::new(&table).expect("a valid table");
    let estimate = estimator.update_full(&sample(0.2));
    let known = Method::ALL.map(|method| is_known(&estimator, &estimate, method)[0]);
    assert_eq!(known, [false, true, false, false]);
}

#[test]
fn fusion_outlives_its_measurements() {
    let segments = [segment::<f64>(2)];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 1, 10>::new(&table).expect("a valid table");
    assert_eq!(estimator.update_full(&Sample::missing(0)).segments[0].fusion, None);
    let measured = estimator.update_full(&sample(0.4)).segments[0].fusion.expect("it was measured");
    let later = estimator.update_full(&Sample::missing(0)).segments[0].fusion.expect("it was measured");
    assert_eq!(later, measured);
}

#[test]
fn the_fused_world_shape_chains_the_fused_points_by_the_fused_angles() {
    let segments = [segment::<f64>(2); 2];
    let table = table(&segments);
    let mut estimator = Estimator::<f64, 2, 10>::new(&table).expect("a valid table");
    estimator.update_full(&sample(0.2));
    let estimate = estimator.update_full(&sample(0.6));
    let [first, second] = [0, 1].map(|i| estimate.segments[i].fusion.expect("it was measured"));
    let tip = estimator.shape(&estimate, Method::Fusion)[1].end.expect("all is known");
    let (sin, cos) = first.theta.rad().sin_cos();
    let x = first.end.x + second.end.x * cos + second.end.y * sin;
    let y = first.end.y - second.end.x * sin + second.end.y * cos;
    assert!((tip.x - x).hypot(tip.y - y) < 1e-10, "the polynomials err by 2e-11");
}

#[test]
fn a_table_of_no_segments_is_refused() {
    let error = Estimator::<f64, 6, 10>::new(&table(&[])).err();
    assert_eq!(error, Some(ConfigError::Segments { found: 0, room: 6 }));
}

#[test]
fn a_table_of_too_many_segments_is_refused() {
    let error = Estimator::<f64, 6, 10>::new(&table(&[segment(2); 7])).err();
    assert_eq!(error, Some(ConfigError::Segments { found: 7, room: 6 }));
    assert_eq!(error.map(|error| error.to_string()).as_deref(), Some("the table has 7 segments, expected 1 to 6"));
}

#[test]
fn a_window_that_is_empty_or_too_long_is_refused() {
    let segments = [segment::<f64>(2)];
    let error = |window| Estimator::<f64, 6, 10>::new(&ArmConfig { anchor: rule(window), ..table(&segments) }).err();
    assert_eq!(error(0), Some(ConfigError::Window { found: 0, room: 10 }));
    assert_eq!(error(10), None);
    assert_eq!(error(11), Some(ConfigError::Window { found: 11, room: 10 }));
    let text = error(11).map(|error| error.to_string());
    assert_eq!(text.as_deref(), Some("the anchor's window is 11 values, expected 1 to 10"));
}

#[test]
fn methods_have_the_files_names_in_the_columns_order() {
    assert_eq!(Method::ALL.map(Method::name), ["bend", "imu_o", "imu_c", "fusion"]);
}

#[test]
fn a_map_of_a_narrow_range_loses_no_digits_in_fixed_point() {
    // c2, c1 and c0 are up to 450 and cancel; about their own range they are below 2.
    let (c2, c1, c0, volts) = (100.0, -420.0, 440.0, [2.0, 2.2]);
    let (float, fixed) = (quadratic::<f64>(c2, c1, c0, volts), quadratic::<Q>(c2, c1, c0, volts));
    for counts in (2482..=2729).step_by(13) {
        let v = f64::from(counts) * 3.3 / 4095.0;
        let exact = c2 * v * v + c1 * v + c0;
        let (float, fixed) = float.angle(counts).zip(fixed.angle(counts)).expect("counts of the range");
        assert!((float - exact).abs() < 1e-11);
        // Three coefficients and two products, each rounded by half a step.
        assert!((fixed.to_f64() - exact).abs() <= 2.5 * LSB);
    }
}

#[test]
fn counts_beyond_a_whole_turn_of_the_map_are_no_reading() {
    // A sensor of 0.2 V: at the rails its map is at 4 turns.
    let map = quadratic::<Q>(0.0, 15.0, -30.0, [1.9, 2.1]);
    assert_eq!((map.angle(0), map.angle(4095)), (None, None));
    let volts = |counts: u16| f64::from(counts) * 3.3 / 4095.0;
    for counts in 0..=4095 {
        let angle: f64 = 15.0 * volts(counts) - 30.0;
        assert_eq!(map.angle(counts).is_some(), angle.abs() <= std::f64::consts::TAU, "{counts} counts, {angle} rad");
    }
}
