//! Any input is survived, with either drift correction and with every number type.

mod common;

use common::sensor;
use estimator_core::{
    AnchorConfig, Angle, ArmConfig, BiasFilterConfig, ContactConfig, Covariance, Estimator, FusedOps, ImuReading,
    KalmanParams, Method, Phase, Q, Sample, SegmentConfig, Turns, UncertaintyConfig,
};
use proptest::prelude::*;

/// Ten values at 10 Hz, and 0.5°.
const ANCHOR: AnchorConfig = AnchorConfig {
    window: 10,
    rate_millihertz: 10_000,
    sample_rate_millihertz: 10_000,
    threshold: Turns::from_bits(5_965_232),
};

/// Segments with two bend sensors, none and one.
fn segments<S: FusedOps>() -> [SegmentConfig<S>; 3] {
    let noise = KalmanParams {
        q: S::from_f64(0.5),
        r_imu: S::from_f64(0.25),
        r_bend: S::one(),
        h_imu: S::one(),
        h_bend: S::one(),
    };
    [[Some(sensor()); 2], [None; 2], [Some(sensor()), None]].map(|bend| SegmentConfig {
        bend,
        orient: noise,
        coord: noise,
        ..SegmentConfig::uncalibrated(0.08, 0.017)
    })
}

fn reading() -> impl Strategy<Value = Option<ImuReading>> {
    let unit = prop::array::uniform4(-1.0..1.0_f64).prop_map(|parts| {
        let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        ImuReading::Quaternion(parts.map(|part| (part / length * 1_073_741_824.0) as i32))
    });
    let junk = any::<[i32; 4]>().prop_map(ImuReading::Quaternion);
    let registers = any::<[i16; 4]>().prop_map(ImuReading::from_bno055);
    let heading = any::<i32>().prop_map(|bits| ImuReading::Heading(Phase::from_bits(bits)));
    prop::option::of(prop_oneof![unit, junk, registers, heading])
}

fn any_sample() -> impl Strategy<Value = Sample<3>> {
    let counts = prop::array::uniform3(prop::array::uniform2(any::<Option<u16>>()));
    (counts, prop::array::uniform3(reading()), any::<u64>()).prop_map(|(bend, imu, time_us)| Sample {
        time_us,
        bend,
        imu,
    })
}

/// Samples with gaps of any length between them.
fn gapped_samples() -> impl Strategy<Value = Vec<Sample<3>>> {
    let gap = prop_oneof![0_u64..20_000, 0_u64..2_000_000, 0_u64..10_000_000_000, any::<u64>()];
    prop::collection::vec((any_sample(), gap), 1..120).prop_map(|samples| {
        let mut time_us = 0_u64;
        let at = |(sample, gap): (Sample<3>, u64)| {
            time_us = time_us.saturating_add(gap);
            Sample { time_us, ..sample }
        };
        samples.into_iter().map(at).collect()
    })
}

/// All numbers that an estimator with the moving-average anchor computes from these samples.
fn numbers<S: FusedOps>(samples: &[Sample<3>], tare_samples: u32) -> Vec<f64> {
    numbers_by::<S>(samples, tare_samples, None)
}

fn numbers_by<S: FusedOps>(
    samples: &[Sample<3>],
    tare_samples: u32,
    bias_filter: Option<BiasFilterConfig>,
) -> Vec<f64> {
    let segments = segments::<S>();
    let variance = Q::from_f64(0.01);
    let uncertainty = UncertaintyConfig {
        theta: variance,
        bias_share: Q::from_f64(0.5),
        bend: variance,
        contact: variance,
        heading: variance,
        end: variance,
    };
    let contact = ContactConfig { bend: Turns::from_rad(0.1), coupling: Turns::from_rad(0.1) };
    let (contact, uncertainty) = (bias_filter.map(|_| contact), bias_filter.map(|_| uncertainty));
    let table = ArmConfig {
        tare_samples,
        anchor: ANCHOR,
        bias_filter,
        contact,
        uncertainty,
        ..ArmConfig::uncalibrated(&segments)
    };
    let mut estimator = Estimator::<S, 3, 10>::new(&table).expect("a valid table");
    let mut numbers = Vec::new();
    for sample in samples {
        let estimate = estimator.update_full(sample);
        assert_eq!((estimate.time_us, estimate.segments.len()), (sample.time_us, 3));
        for shape in Method::ALL.map(|method| estimator.shape(&estimate, method)) {
            for segment in shape {
                numbers.extend(segment.theta.map(Angle::rad));
                numbers.extend(segment.end.into_iter().flat_map(|end| [end.x.to_f64(), end.y.to_f64()]));
            }
        }
        let ends = estimator.uncertainties().into_iter().filter_map(|segment| segment.end);
        numbers.extend(ends.flat_map(Covariance::square_metres));
    }
    numbers
}

/// Returns `true` if `update` computes the same shapes of these samples as `update_full` and `shape`.
fn the_updates_agree<S: FusedOps>(samples: &[Sample<3>], tare_samples: u32) -> bool {
    let segments = segments::<S>();
    let table = ArmConfig { tare_samples, anchor: ANCHOR, ..ArmConfig::uncalibrated(&segments) };
    let mut stepped = Estimator::<S, 3, 10>::new(&table).expect("a valid table");
    let mut fused = stepped.clone();
    samples.iter().all(|sample| {
        let estimate = stepped.update_full(sample);
        *fused.update(sample) == stepped.shape(&estimate, Method::Fusion)
    })
}

proptest! {
    #[test]
    fn the_fused_shape_alone_is_that_of_the_whole_estimate(
        samples in prop::collection::vec(any_sample(), 1..60),
        tare in 0_u32..20,
    ) {
        prop_assert!(the_updates_agree::<Q>(&samples, tare) && the_updates_agree::<f64>(&samples, tare));
    }

    #[test]
    fn any_input_gives_finite_floats(samples in prop::collection::vec(any_sample(), 1..60), tare in 0_u32..20) {
        prop_assert!(numbers::<f64>(&samples, tare).into_iter().all(f64::is_finite));
    }

    #[test]
    fn any_input_is_survived_in_fixed_point(samples in prop::collection::vec(any_sample(), 1..60), tare in 0_u32..20) {
        prop_assert_eq!(numbers::<Q>(&samples, tare).len(), numbers::<f64>(&samples, tare).len());
    }

    #[test]
    fn with_the_bias_filter_any_input_gives_finite_floats(samples in gapped_samples(), tare in 0_u32..20) {
        let numbers = numbers_by::<f64>(&samples, tare, Some(BiasFilterConfig::BNO055));
        prop_assert!(numbers.into_iter().all(f64::is_finite));
    }

    /// The filter takes the same decisions for every number type.
    #[test]
    fn with_the_bias_filter_any_input_is_survived_in_fixed_point(samples in gapped_samples(), tare in 0_u32..20) {
        let filter = Some(BiasFilterConfig::BNO055);
        let (fixed, float) = (numbers_by::<Q>(&samples, tare, filter), numbers_by::<f64>(&samples, tare, filter));
        prop_assert_eq!(fixed.len(), float.len());
    }

    #[test]
    fn with_the_bias_filter_times_in_any_order_are_survived(samples in prop::collection::vec(any_sample(), 1..60)) {
        let numbers = numbers_by::<Q>(&samples, 5, Some(BiasFilterConfig::BNO055));
        prop_assert!(numbers.into_iter().all(f64::is_finite));
    }
}
