//! Conversions between messages and `estimator-core`'s types, the same on board and host.

use estimator_core::{Contact, ImuReading, Q, SegmentShape, Shape, VARIANCE_SCALE};

use crate::bounded::vector;
use crate::constants::BEND_PER_SEGMENT;
use crate::message::{Estimate, Sample, SegmentEstimate, SegmentUncertainty, Uncertainty};

/// For an estimator of any number of segments; readings of segments that it does not have are left out.
impl<const N: usize> From<&Sample> for estimator_core::Sample<N> {
    fn from(sample: &Sample) -> Self {
        let mut raw = Self::missing(sample.time_us);
        let (bend, _) = sample.bend.as_chunks::<BEND_PER_SEGMENT>();
        raw.bend.iter_mut().zip(bend).for_each(|(raw, counts)| *raw = *counts);
        let imu = sample.imu.iter().map(|quaternion| quaternion.map(ImuReading::from_bno055));
        raw.imu.iter_mut().zip(imu).for_each(|(raw, reading)| *raw = reading);
        raw
    }
}

impl Estimate {
    /// Converts the shape by [`Method::Fusion`](estimator_core::Method::Fusion), whose angles have no whole turns, after the
    /// sample of this tick.
    #[must_use]
    pub fn of<const N: usize>(tick: u32, shape: &Shape<Q, N>) -> Self {
        let segment = |SegmentShape { theta, end }: &SegmentShape<Q>| {
            theta.zip(*end).map(|(theta, end)| SegmentEstimate {
                theta: theta.remainder.to_bits(),
                end: [end.x.to_bits(), end.y.to_bits()],
            })
        };
        Self { tick, segments: vector(shape.iter().map(segment)) }
    }
}

impl Uncertainty {
    /// Converts the covariances and contacts of an arm of so many segments after the sample of this tick. A table without
    /// `[uncertainty]` or `[contact]` leaves them unknown.
    #[must_use]
    pub fn of(tick: u32, segments: usize, errors: &[estimator_core::Uncertainty], contacts: &[Contact]) -> Self {
        let segment = |i: usize| {
            let error = errors.get(i);
            let contact = contacts.get(i);
            SegmentUncertainty {
                theta: error.and_then(|error| error.theta).map(Q::to_bits),
                end: error.and_then(|error| error.end).map(|end| [end.xx, end.xy, end.yy].map(Q::to_bits)),
                contact_percent: contact.map_or(0, |contact| contact.score_percent.min(u8::MAX.into()) as u8),
                in_contact: contact.is_some_and(|contact| contact.in_contact),
            }
        };
        Self { tick, segments: vector((0..segments).map(segment)) }
    }
}

impl SegmentUncertainty {
    /// Variance of θ_i, rad², for reports.
    #[must_use]
    pub fn theta_rad2(&self) -> Option<f64> {
        self.theta.map(variance)
    }

    /// Covariance xx, xy, yy of the segment's end in {W}, m², for reports.
    #[must_use]
    pub fn end_m2(&self) -> Option<[f64; 3]> {
        self.end.map(|end| end.map(variance))
    }
}

fn variance(bits: i32) -> f64 {
    Q::from_bits(bits).to_f64() / VARIANCE_SCALE
}
