//! Board and host make the same of a sample.

use estimator_core::{ArmConfig, Contact, Covariance, Estimator, ImuReading, Method, Q, SegmentConfig};
use proptest::prelude::*;
use telemetry::{Estimate, MAX_SEGMENTS, Sample, SegmentUncertainty, Uncertainty};

use crate::values::{many, sample_of};

proptest! {
    #[test]
    fn every_reading_goes_to_the_estimator_under_its_own_number(sample in sample_of(MAX_SEGMENTS)) {
        let raw = estimator_core::Sample::<MAX_SEGMENTS>::from(&sample);
        prop_assert_eq!(raw.time_us, sample.time_us);
        for (i, counts) in sample.bend.iter().enumerate() {
            prop_assert_eq!(raw.bend[i / 2][i % 2], *counts, "bend sensor {}", i);
        }
        let imu: Vec<_> = sample.imu.iter().map(|quaternion| quaternion.map(ImuReading::from_bno055)).collect();
        prop_assert_eq!(&raw.imu[..], &imu);
    }

    #[test]
    fn an_estimator_for_a_longer_arm_has_no_reading_beyond_the_arm(sample in sample_of(3)) {
        let raw = estimator_core::Sample::<6>::from(&sample);
        prop_assert_eq!(&raw.bend[3..], [[None; 2]; 3]);
        prop_assert_eq!(&raw.imu[3..], [None; 3]);
    }
}

#[test]
fn an_estimate_has_the_bits_of_the_shape_and_ends_where_it_is_unknown() {
    let segments = [SegmentConfig::<Q>::uncalibrated(0.080, 0.017); 6];
    let table = ArmConfig::uncalibrated(&segments);
    let mut estimator = Estimator::<Q, 6, 100>::new(&table).expect("six segments");
    // 90° about z, -90°, none; the fifth is not read.
    let (left, right, straight) = ([11585, 0, 0, 11585], [11585, 0, 0, -11585], [16384, 0, 0, 0]);
    let imu = [Some(left), Some(straight), Some(right), Some(straight), None, Some(straight)];
    let imu = imu.into_iter().collect();
    let sample = Sample { tick: 7, time_us: 70_000, tare_epoch: 0, bend: many(12, None), imu };
    let raw = estimator.update_full(&(&sample).into());
    let shape = estimator.shape(&raw, Method::ImuO);

    let estimate = Estimate::of(sample.tick, &shape);
    assert_eq!(estimate.tick, 7);
    for (segment, shape) in estimate.segments.iter().zip(&shape).take(4) {
        let (segment, end) = (segment.as_ref().expect("it was read"), shape.end.expect("it was read"));
        assert_eq!(Some(Q::from_bits(segment.theta)), shape.theta.map(|theta| theta.remainder));
        assert_eq!(segment.end.map(Q::from_bits), [end.x, end.y]);
    }
    assert_eq!(estimate.segments[4..], [None, None]);
}

#[test]
fn an_uncertainty_has_the_bits_of_the_covariances_and_the_segments_that_are_touched() {
    let [theta, xx, xy, yy] = [0.5, 1.5, -0.25, 2.0].map(Q::from_f64);
    let errors = [
        estimator_core::Uncertainty { theta: Some(theta), end: Some(Covariance { xx, xy, yy }) },
        estimator_core::Uncertainty { theta: Some(theta), end: None },
    ];
    let contacts = [Contact { score_percent: 300, in_contact: true }, Contact { score_percent: 99, in_contact: false }];

    let found = Uncertainty::of(7, 6, &errors, &contacts);
    assert_eq!(found.tick, 7);
    // 0.5 in units of 2⁻²⁶, and so on; 300 is more than a byte holds.
    let of = |theta, end, contact_percent, in_contact| SegmentUncertainty { theta, end, contact_percent, in_contact };
    assert_eq!(found.segments[0], of(Some(1 << 25), Some([3 << 25, -(1 << 24), 1 << 27]), 255, true));
    assert_eq!((found.segments[0].theta_rad2(), found.segments[1].end_m2()), (Some(0.5 / 64.0), None));
    assert_eq!(found.segments[0].end_m2(), Some([1.5 / 64.0, -0.25 / 64.0, 2.0 / 64.0]));
    assert_eq!(found.segments[1], of(Some(1 << 25), None, 99, false));
    assert_eq!(found.segments[2..], [SegmentUncertainty::default(); 4]);
}
