//! Between messages and `estimator-core`: the one way for board and host.

use estimator_core::{Contact, ImuReading, Q, SegmentShape, Shape, VARIANCE_SCALE};

use crate::message::{Estimate, SEGMENTS, Sample, SegmentEstimate, SegmentUncertainty, Uncertainty};

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
                theta: theta.remainder.to_bits(),
                end: [end.x.to_bits(), end.y.to_bits()],
            });
        }
        Self { tick, segments }
    }
}

impl Uncertainty {
    /// How far the shape after the sample of this tick may be off, and what touches the arm. Of what the table does not say
    /// how to tell, nothing is known.
    #[must_use]
    pub fn of(tick: u32, errors: &[estimator_core::Uncertainty], contacts: &[Contact]) -> Self {
        let mut segments = [SegmentUncertainty::default(); SEGMENTS];
        for (segment, error) in segments.iter_mut().zip(errors) {
            segment.theta = error.theta.map(Q::to_bits);
            segment.end = error.end.map(|end| [end.xx, end.xy, end.yy].map(Q::to_bits));
        }
        for (segment, contact) in segments.iter_mut().zip(contacts) {
            segment.contact_percent = contact.score_percent.min(u8::MAX.into()) as u8;
            segment.is_touched = contact.in_contact;
        }
        Self { tick, segments }
    }
}

impl SegmentUncertainty {
    /// Variance of θ_i, rad². For reports.
    #[must_use]
    pub fn theta_rad2(&self) -> Option<f64> {
        self.theta.map(variance)
    }

    /// Covariance xx, xy, yy of the segment's end in {W}, m². For reports.
    #[must_use]
    pub fn end_m2(&self) -> Option<[f64; 3]> {
        self.end.map(|end| end.map(variance))
    }
}

fn variance(bits: i32) -> f64 {
    Q::from_bits(bits).to_f64() / VARIANCE_SCALE
}

/// Which segments something touches.
#[must_use]
pub fn touched(contacts: &[Contact]) -> [bool; SEGMENTS] {
    let mut touched = [false; SEGMENTS];
    touched.iter_mut().zip(contacts).for_each(|(touched, contact)| *touched = contact.in_contact);
    touched
}
