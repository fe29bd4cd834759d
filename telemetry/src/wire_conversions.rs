//! Conversions between messages and their fixed-width forms.

use heapless::Vec;
use postcard_schema::Schema;
use postcard_schema::schema::NamedType;

use crate::bounded::vector;
use crate::constants::BEND_PER_SEGMENT;
use crate::message::{Estimate, Sample, SegmentEstimate, SegmentUncertainty, Uncertainty};
use crate::wire::{EstimateWire, SampleWire, UncertaintyWire};

impl Schema for Sample {
    const SCHEMA: &'static NamedType = SampleWire::SCHEMA;
}

impl Schema for Estimate {
    const SCHEMA: &'static NamedType = EstimateWire::SCHEMA;
}

impl Schema for Uncertainty {
    const SCHEMA: &'static NamedType = UncertaintyWire::SCHEMA;
}

impl From<Sample> for SampleWire {
    fn from(sample: Sample) -> Self {
        let [time_us @ .., _, _] = sample.time_us.to_le_bytes();
        let (bend, _) = sample.bend.as_chunks();
        let segment = |(bend, imu): (&[Option<u16>; BEND_PER_SEGMENT], &Option<[i16; 4]>)| {
            let bend = bend.map(|counts| counts.unwrap_or_default().to_le_bytes());
            (bend, imu.unwrap_or_default().map(i16::to_le_bytes))
        };
        Self {
            tick: sample.tick.to_le_bytes(),
            time_us,
            tare_epoch: sample.tare_epoch,
            bend_read: (mask(&sample.bend) as u16).to_le_bytes(),
            imu_read: mask(&sample.imu) as u8,
            segments: vector(bend.iter().zip(&sample.imu).map(segment)),
        }
    }
}

impl From<SampleWire> for Sample {
    fn from(wire: SampleWire) -> Self {
        let [t0, t1, t2, t3, t4, t5] = wire.time_us;
        let mut bend_read = Bits(u16::from_le_bytes(wire.bend_read).into());
        let mut imu_read = Bits(wire.imu_read.into());
        let (mut bend, mut imu) = (Vec::new(), Vec::new());
        for (counts, quaternion) in &wire.segments {
            // There is room for each segment's sensors.
            let _ = bend.extend_from_slice(&counts.map(|counts| bend_read.next(u16::from_le_bytes(counts))));
            let _ = imu.push(imu_read.next(quaternion.map(i16::from_le_bytes)));
        }
        Self {
            tick: u32::from_le_bytes(wire.tick),
            time_us: u64::from_le_bytes([t0, t1, t2, t3, t4, t5, 0, 0]),
            tare_epoch: wire.tare_epoch,
            bend,
            imu,
        }
    }
}

impl From<Estimate> for EstimateWire {
    fn from(estimate: Estimate) -> Self {
        let bytes = |SegmentEstimate { theta, end: [x, y] }: &_| [*theta, *x, *y].map(i32::to_le_bytes);
        Self {
            tick: estimate.tick.to_le_bytes(),
            known: mask(&estimate.segments) as u8,
            segments: vector(estimate.segments.iter().map(|segment| segment.as_ref().map(bytes).unwrap_or_default())),
        }
    }
}

impl From<EstimateWire> for Estimate {
    fn from(wire: EstimateWire) -> Self {
        let mut known = Bits(wire.known.into());
        let segment = |segment: &[[u8; 4]; 3]| {
            let [theta, x, y] = segment.map(i32::from_le_bytes);
            known.next(SegmentEstimate { theta, end: [x, y] })
        };
        Self { tick: u32::from_le_bytes(wire.tick), segments: vector(wire.segments.iter().map(segment)) }
    }
}

impl From<Uncertainty> for UncertaintyWire {
    fn from(uncertainty: Uncertainty) -> Self {
        let tick = uncertainty.tick.to_le_bytes();
        let mut wire = Self { tick, theta_known: 0, end_known: 0, in_contact: 0, segments: Vec::new() };
        for (i, segment) in uncertainty.segments.iter().enumerate() {
            wire.theta_known |= u8::from(segment.theta.is_some()) << i;
            wire.end_known |= u8::from(segment.end.is_some()) << i;
            wire.in_contact |= u8::from(segment.in_contact) << i;
            let [xx, xy, yy] = segment.end.unwrap_or_default();
            let variances = [segment.theta.unwrap_or_default(), xx, xy, yy];
            // Both have room for as many segments.
            let _ = wire.segments.push((segment.contact_percent, variances.map(i32::to_le_bytes)));
        }
        wire
    }
}

impl From<UncertaintyWire> for Uncertainty {
    fn from(wire: UncertaintyWire) -> Self {
        let [mut theta_known, mut end_known, mut in_contact] =
            [wire.theta_known, wire.end_known, wire.in_contact].map(|mask| Bits(mask.into()));
        let segment = |(contact_percent, variances): &(u8, [[u8; 4]; 4])| {
            let [theta, end @ ..] = variances.map(i32::from_le_bytes);
            SegmentUncertainty {
                theta: theta_known.next(theta),
                end: end_known.next(end),
                contact_percent: *contact_percent,
                in_contact: in_contact.next(()).is_some(),
            }
        };
        Self { tick: u32::from_le_bytes(wire.tick), segments: vector(wire.segments.iter().map(segment)) }
    }
}

/// Bit i is set where the i-th value is there.
fn mask<T>(values: &[Option<T>]) -> u32 {
    values.iter().rev().fold(0, |mask, value| mask << 1 | u32::from(value.is_some()))
}

/// Bits of a mask, from the lowest.
struct Bits(u32);

impl Bits {
    /// The value, if the next bit is set.
    fn next<T>(&mut self, value: T) -> Option<T> {
        let is_set = self.0 & 1 == 1;
        self.0 >>= 1;
        is_set.then_some(value)
    }
}
