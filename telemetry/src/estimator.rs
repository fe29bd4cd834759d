//! Between messages and `estimator-core`: the one way for board and host.

use estimator_core::{ImuReading, Q, SegmentShape, Shape};

use crate::message::{Estimate, SEGMENTS, Sample, SegmentEstimate};

/// For an estimator with room for any number of segments; what it has no room for is left out.
impl<const N: usize> From<&Sample> for estimator_core::Sample<N> {
    fn from(sample: &Sample) -> Self {
        let mut raw = Self::missing(sample.time_us);
        let (bend, _) = sample.bend.as_chunks();
        raw.bend.iter_mut().zip(bend).for_each(|(raw, counts)| *raw = *counts);
        let imu = sample.imu.map(|quaternion| quaternion.map(ImuReading::from_bno055));
        raw.imu.iter_mut().zip(imu).for_each(|(raw, reading)| *raw = reading);
        raw
    }
}

impl Estimate {
    /// The shape by [`Method::Fusion`](estimator_core::Method::Fusion), whose angles have no whole turns, after the
    /// sample of this tick.
    #[must_use]
    pub fn of<const N: usize>(tick: u32, shape: &Shape<Q, N>) -> Self {
        let mut segments = [None; SEGMENTS];
        for (segment, SegmentShape { theta, end }) in segments.iter_mut().zip(shape) {
            *segment = theta.zip(*end).map(|(theta, end)| SegmentEstimate {
                theta: theta.rest.to_bits(),
                end: [end.x.to_bits(), end.y.to_bits()],
            });
        }
        Self { tick, segments }
    }
}
