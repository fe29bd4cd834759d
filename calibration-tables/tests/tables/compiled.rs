//! From a table to the estimator's parameters.

use calibration_tables::{
    AnalogPin, ArmFile, BoardSegmentToml, BoardToml, DigitalPin, FileError, ImuToml, RegulatorToml,
};
use estimator_core::{
    BiasFilterConfig, Estimator, ImuReading, Method, OffsetAt, Q, SENSORS_PER_SEGMENT, Sample, SegmentConfig,
    VARIANCE_SCALE,
};

use super::common::{DESCRIPTION, TABLE, edited, parse};

/// The first segment, compiled in floats.
fn first(text: &str, rate_hz: f64) -> SegmentConfig<f64> {
    parse(text).compile::<f64>(rate_hz).expect("it is a table").config().segments[0]
}

fn near(found: f64, expected: f64) {
    // Floats through one conversion of units and back.
    assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{found}, expected {expected}");
}

#[test]
fn an_arm_description_is_not_compiled_and_names_the_segment() {
    let error = parse(DESCRIPTION).compile::<Q>(10.0).expect_err("it is no table");
    assert!(matches!(error, FileError::NotCalibrated(1)), "{error}");
}

#[test]
fn a_table_of_which_one_segment_is_missing_names_that_segment() {
    let error = parse(&edited("bend = []\n", "")).compile::<Q>(10.0).expect_err("it is no table");
    assert!(matches!(error, FileError::NotCalibrated(2)), "{error}");
}

#[test]
fn an_arm_without_bend_sensors_is_a_table() {
    let file = parse(&format!("{DESCRIPTION}bend = []\n"));
    let compiled = file.compile::<Q>(10.0).expect("it is a table");
    let table = compiled.config();
    assert_eq!(table.segments[0].bend, [None; SENSORS_PER_SEGMENT]);
    assert!(Estimator::<Q, 1, 100>::new(&table).is_ok());
}

#[test]
fn geometry_is_in_metres() {
    let segment = first(TABLE, 10.0);
    near(segment.length, 0.080);
    near(segment.offset, 0.017);
    assert_eq!(segment.offset_at, OffsetAt::End);
    assert_eq!(parse(TABLE).compile::<f64>(10.0).expect("a table").config().segments[1].offset_at, OffsetAt::Start);
}

#[test]
fn reference_headings_are_compiled() {
    let compiled = parse(TABLE).compile::<f64>(10.0).expect("a table");
    let found: Vec<f64> =
        compiled.config().segments.iter().map(|segment| segment.reference.rad().to_degrees()).collect();
    // Turns are whole units of 2⁻³² turns.
    assert!((found[0] - 5.0).abs() < 1e-7 && (found[1] + 5.0).abs() < 1e-7, "{found:?}");
}

#[test]
fn the_reference_pose_is_straight_where_none_is_given() {
    let segment = first(&edited("heading_deg = [5.0, -5.0]\n", ""), 10.0);
    assert_eq!(segment.reference.bits(), 0);
}

/// θ = c2 V² + c1 V + c0, V = counts · 3.3 / 4095, within the sensor's voltages.
#[test]
fn the_compiled_map_is_that_of_the_file() {
    let sensor = first(TABLE, 10.0).bend[0].expect("the segment has a sensor");
    for counts in [500_u16, 1000, 2000, 3000, 3200] {
        let volts = f64::from(counts) * 3.3 / 4095.0;
        let (found, expected) = (sensor.map.angle(counts).expect("a reading"), 0.1 * volts * volts + 0.8 * volts - 1.5);
        assert!((found - expected).abs() < 1e-9, "{counts} counts: {found}, expected {expected}");
    }
}

#[test]
fn a_sensor_of_which_only_the_map_is_known_compiles_with_defaults() {
    let text = format!("{DESCRIPTION}bend = [{{ c0 = -1.5, c1 = 0.8, c2 = 0.1 }}]\n");
    let segment = first(&text, 10.0);
    let sensor = segment.bend[0].expect("the segment has a sensor");
    for counts in [1_u16, 4095] {
        let volts = f64::from(counts) * 3.3 / 4095.0;
        let expected = 0.1 * volts * volts + 0.8 * volts - 1.5;
        let found = sensor.map.angle(counts).expect("a reading");
        assert!((found - expected).abs() < 1e-9, "the whole range of the converter: {counts} counts");
    }
    for noise in [segment.orient, segment.coord] {
        assert!(noise.q > 0.0 && noise.r_imu > 0.0 && noise.r_bend > 0.0, "{noise:?}");
        near(noise.h_imu, 1.0);
        near(noise.h_bend, 1.0);
    }
}

#[test]
fn the_tare_takes_the_samples_of_its_seconds() {
    let samples = |text: &str, rate_hz| parse(text).compile::<Q>(rate_hz).expect("a table").config().tare_samples;
    assert_eq!((samples(TABLE, 10.0), samples(TABLE, 100.0)), (10, 100));
    let long = edited("seconds = 1.0", "seconds = 2.5");
    assert_eq!((samples(&long, 10.0), samples(&long, 100.0)), (25, 250));
    assert_eq!(samples(&edited("seconds = 1.0", "seconds = 0.0"), 100.0), 0);
    assert_eq!(samples(&edited("seconds = 1.0", "seconds = 0.001"), 10.0), 1, "a short tare is still one");
}

#[test]
fn the_anchor_is_averaged_down_to_its_own_rate() {
    let rates = |rate_hz| {
        let anchor = parse(TABLE).compile::<Q>(rate_hz).expect("a table").config().anchor;
        (anchor.rate_millihertz, anchor.sample_rate_millihertz)
    };
    assert_eq!((rates(10.0), rates(100.0)), ((10_000, 10_000), (10_000, 100_000)));
}

#[test]
fn window_and_threshold_are_those_of_the_file_at_any_rate() {
    for rate_hz in [10.0, 100.0] {
        let anchor = parse(TABLE).compile::<Q>(rate_hz).expect("a table").config().anchor;
        assert_eq!(anchor.window, 100);
        // Units of 2⁻³² turns.
        assert!((anchor.threshold.rad().to_degrees() - 0.5).abs() < 1e-7);
    }
}

/// A file whose process noise is small enough not to meet the filters' limit.
fn slow() -> String {
    edited("q = 0.16", "q = 0.01").replacen("q = 0.0002", "q = 1e-5", 1)
}

#[test]
fn process_noise_is_per_second() {
    let (slow_rate, fast_rate) = (first(&slow(), 10.0), first(&slow(), 100.0));
    for (ten, hundred) in [(slow_rate.orient, fast_rate.orient), (slow_rate.coord, fast_rate.coord)] {
        assert!(ten.q > 0.0);
        near(hundred.q * 10.0, ten.q);
    }
}

#[test]
fn measurement_noise_does_not_depend_on_the_rate() {
    let (ten, hundred) = (first(&slow(), 10.0), first(&slow(), 100.0));
    near(hundred.orient.r_imu, ten.orient.r_imu);
    near(hundred.orient.r_bend, ten.orient.r_bend);
}

/// The gains depend on the ratios alone.
#[test]
fn covariances_keep_their_ratios() {
    let noise = first(&slow(), 10.0).orient;
    near(noise.r_bend / noise.r_imu, 0.002 / 0.0002);
    near(noise.q / noise.r_bend, 0.01 / 10.0 / 0.002);
}

#[test]
fn fixed_point_and_floats_compile_to_the_same_values() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("planar-6.toml");
    let file = ArmFile::load(&path).expect("the reference table is committed");
    let (fixed, float) = (file.compile::<Q>(100.0).expect("a table"), file.compile::<f64>(100.0).expect("a table"));
    for (fixed, float) in fixed.config().segments.iter().zip(float.config().segments) {
        // One unit of fixed point is 2⁻²⁶ at the most.
        let same = |fixed: Q, float: f64| assert!((fixed.to_f64() - float).abs() < 2e-8, "{float}");
        same(fixed.length, float.length);
        same(fixed.orient.r_imu, float.orient.r_imu);
        same(fixed.coord.r_bend, float.coord.r_bend);
        for (fixed, float) in fixed.bend.iter().flatten().zip(float.bend.iter().flatten()) {
            let mut read = 0;
            for counts in (0..4095_u16).step_by(5) {
                let (fixed, float) = (fixed.map.angle(counts), float.map.angle(counts));
                assert_eq!(fixed.is_some(), float.is_some(), "{counts} counts");
                if let Some((fixed, float)) = fixed.zip(float) {
                    let error = fixed.to_f64() - float;
                    assert!(error.abs() < 1e-6, "{error} rad at {counts} counts");
                    read += 1;
                }
            }
            assert!(read > 100, "{read} readings");
        }
    }
}

#[test]
fn the_reference_table_runs() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("planar-6.toml");
    let file = ArmFile::load(&path).expect("the reference table is committed");
    let compiled = file.compile::<Q>(100.0).expect("a table");
    let table = compiled.config();
    let mut estimator = Estimator::<Q, 6, 100>::new(&table).expect("it has six segments");
    let sample = |k: u64| Sample {
        bend: [[Some(2300); SENSORS_PER_SEGMENT]; 6],
        imu: [Some(ImuReading::from_bno055([16_384, 0, 0, 0])); 6],
        ..Sample::missing(k * 10_000)
    };
    let tare = u64::from(table.tare_samples);
    let estimate = (0..=tare).map(|k| estimator.update_full(&sample(k))).last().expect("a sample");
    let tip = estimator.shape(&estimate, Method::Fusion)[5].end.expect("every sensor was read");
    assert!(tip.x.to_f64().hypot(tip.y.to_f64()) < 0.5821, "no farther than the straight arm is long");
}

#[test]
fn the_checksum_is_that_of_the_parameters_and_not_of_the_file() {
    let table = parse(TABLE);
    let spaced = parse(&TABLE.replace(" = ", "  =  "));
    assert_eq!(table.compile::<Q>(100.0).unwrap().checksum(), spaced.compile::<Q>(100.0).unwrap().checksum());
}

#[test]
fn the_checksum_tells_the_smallest_change_of_a_parameter() {
    let whole = parse(TABLE).compile::<Q>(100.0).unwrap().checksum();
    let other_rate = parse(TABLE).compile::<Q>(50.0).unwrap().checksum();
    // Half a micrometre: 33 steps of fixed point.
    let longer = parse(&edited("length_mm = 80.0", "length_mm = 80.0005")).compile::<Q>(100.0).unwrap().checksum();
    assert!(whole != other_rate && whole != longer && other_rate != longer);
}

#[test]
fn the_checksum_tells_another_wiring() {
    let wired = |full_scale_kpa: f64, first_pin: u8| {
        let mut table = parse(TABLE);
        let segment = |i: u8| BoardSegmentToml {
            bend: vec![AnalogPin(if i == 0 { first_pin } else { 2 * i }), AnalogPin(2 * i + 1)],
            imu: Some(ImuToml { channel: i, address: 0x28 }),
        };
        let regulators = vec![RegulatorToml { pin: DigitalPin(6), full_scale_kpa }];
        table.board = Some(BoardToml { segments: (0..6).map(segment).collect(), regulators });
        table.compile::<Q>(100.0).expect("a table").checksum()
    };
    let plain = parse(TABLE).compile::<Q>(100.0).expect("a table").checksum();
    let checksums = [plain, wired(280.0, 0), wired(100.0, 0), wired(280.0, 11)];
    for (i, checksum) in checksums.iter().enumerate() {
        assert!(!checksums[..i].contains(checksum), "{i}");
    }
    assert_eq!(wired(280.0, 0), checksums[1]);
}

/// The bias filter of the table with `[drift]` of these lines.
fn bias_filter(drift: &str, rate_hz: f64) -> Option<BiasFilterConfig> {
    let text = edited("[[segment]]", &format!("[drift]\n{drift}\n[[segment]]"));
    parse(&text).compile::<Q>(rate_hz).expect("a table").config().bias_filter
}

#[test]
fn drift_is_left_to_the_anchor_where_nothing_else_is_said() {
    assert_eq!(parse(TABLE).compile::<Q>(10.0).expect("a table").config().bias_filter, None);
    assert_eq!(bias_filter("kind = \"anchor\"", 10.0), None);
}

#[test]
fn the_bias_filter_s_variances_are_squares_of_the_file_s_deviations() {
    let config = bias_filter("kind = \"kalman\"\nstart_deg = 2.0\noffset_deg = 3.0", 10.0).expect("it is wanted");
    let deviation_deg = |variance: Q| (variance.to_f64() / VARIANCE_SCALE).sqrt().to_degrees();
    assert!((deviation_deg(config.initial_bias) - 2.0).abs() < 1e-5, "{config:?}");
    assert!((deviation_deg(config.offset) - 3.0).abs() < 1e-5, "{config:?}");
}

#[test]
fn the_bias_filter_is_the_same_at_any_rate() {
    let drift = "kind = \"kalman\"";
    assert_eq!(bias_filter(drift, 100.0), bias_filter(drift, 10.0));
}

#[test]
fn a_table_with_the_observer_of_version_0_1_runs_the_bias_filter_and_keeps_the_keys_that_both_have() {
    let old = "kind = \"observer\"\nnoise_deg2_s = 40.0\nwalk_deg_per_s = 1e-3\nslope = 0.1\ngate_deg = 8.0\npatience_s = 30.0\n\
               jump_deg = 12.0\nstill_deg = 1.0\ndoubt_deg = 2.5";
    assert_eq!(
        bias_filter(old, 10.0),
        bias_filter("kind = \"kalman\"\nrate_random_walk_deg_per_s_sqrt_s = 1e-3", 10.0)
    );
}
