//! Board and host make the same of a sample.

use estimator_core::{Estimator, ImuReading, Method, Q, Segment, Table};
use proptest::prelude::*;
use telemetry::{Estimate, Sample};

use crate::values::sample;

proptest! {
    #[test]
    fn every_reading_goes_to_the_estimator_under_its_own_number(sample in sample()) {
        let raw = estimator_core::Sample::from(&sample);
        prop_assert_eq!(raw.time_us, sample.time_us);
        for (i, counts) in sample.bend.into_iter().enumerate() {
            prop_assert_eq!(raw.bend[i / 2][i % 2], counts, "bend sensor {}", i);
        }
        prop_assert_eq!(raw.imu, sample.imu.map(|quaternion| quaternion.map(ImuReading::from_bno055)));
    }
}

#[test]
fn an_estimate_has_the_bits_of_the_shape_and_ends_where_it_is_unknown() {
    let segments = [Segment::<Q>::bare(0.080, 0.017); 6];
    let table = Table::bare(&segments);
    let mut estimator = Estimator::<Q, 6, 100>::new(&table).expect("six segments");
    // 90° about z, -90°, none; the fifth is not read.
    let (left, right, straight) = ([11585, 0, 0, 11585], [11585, 0, 0, -11585], [16384, 0, 0, 0]);
    let imu = [Some(left), Some(straight), Some(right), Some(straight), None, Some(straight)];
    let sample = Sample { tick: 7, time_us: 70_000, tare: 0, bend: [None; 12], imu };
    let raw = estimator.step(&(&sample).into());
    let shape = estimator.shape(&raw, Method::ImuO);

    let estimate = Estimate::of(sample.tick, &shape);
    assert_eq!(estimate.tick, 7);
    for (segment, shape) in estimate.segments.iter().zip(&shape).take(4) {
        let (segment, end) = (segment.expect("it was read"), shape.end.expect("it was read"));
        assert_eq!(Some(Q::from_bits(segment.theta)), shape.theta.map(|theta| theta.rest));
        assert_eq!(segment.end.map(Q::from_bits), [end.x, end.y]);
    }
    assert_eq!(estimate.segments[4..], [None, None]);
}
