//! Conversions between messages and their fixed-width forms.

use core::array;

use postcard_schema::Schema;
use postcard_schema::schema::NamedType;

use crate::constants::SEGMENTS;
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
        Self {
            tick: sample.tick.to_le_bytes(),
            time_us: sample.time_us.to_le_bytes(),
            tare_epoch: sample.tare_epoch,
            bend_read: (mask(&sample.bend) as u16).to_le_bytes(),
            imu_read: mask(&sample.imu) as u8,
            bend: sample.bend.map(|counts| counts.unwrap_or_default().to_le_bytes()),
            imu: sample.imu.map(|quaternion| quaternion.unwrap_or_default().map(i16::to_le_bytes)),
        }
    }
}

impl From<SampleWire> for Sample {
    fn from(wire: SampleWire) -> Self {
        Self {
            tick: u32::from_le_bytes(wire.tick),
            time_us: u64::from_le_bytes(wire.time_us),
            tare_epoch: wire.tare_epoch,
            bend: present(u16::from_le_bytes(wire.bend_read).into(), wire.bend.map(u16::from_le_bytes)),
            imu: present(wire.imu_read.into(), wire.imu.map(|quaternion| quaternion.map(i16::from_le_bytes))),
        }
    }
}

impl From<Estimate> for EstimateWire {
    fn from(estimate: Estimate) -> Self {
        let bytes = |SegmentEstimate { theta, end: [x, y] }| [theta, x, y].map(i32::to_le_bytes);
        Self {
            tick: estimate.tick.to_le_bytes(),
            known: mask(&estimate.segments) as u8,
            segments: estimate.segments.map(|segment| segment.map(bytes).unwrap_or_default()),
        }
    }
}

impl From<EstimateWire> for Estimate {
    fn from(wire: EstimateWire) -> Self {
        let segments = wire.segments.map(|segment| {
            let [theta, x, y] = segment.map(i32::from_le_bytes);
            SegmentEstimate { theta, end: [x, y] }
        });
        Self { tick: u32::from_le_bytes(wire.tick), segments: present(wire.known.into(), segments) }
    }
}

impl From<Uncertainty> for UncertaintyWire {
    fn from(uncertainty: Uncertainty) -> Self {
        let tick = uncertainty.tick.to_le_bytes();
        let mut wire =
            Self { tick, theta_known: 0, end_known: 0, in_contact: 0, segments: [Default::default(); SEGMENTS] };
        for (i, (segment, wire_segment)) in uncertainty.segments.iter().zip(&mut wire.segments).enumerate() {
            wire.theta_known |= u8::from(segment.theta.is_some()) << i;
            wire.end_known |= u8::from(segment.end.is_some()) << i;
            wire.in_contact |= u8::from(segment.in_contact) << i;
            let [xx, xy, yy] = segment.end.unwrap_or_default();
            let variances = [segment.theta.unwrap_or_default(), xx, xy, yy];
            *wire_segment = (segment.contact_percent, variances.map(i32::to_le_bytes));
        }
        wire
    }
}

impl From<UncertaintyWire> for Uncertainty {
    fn from(wire: UncertaintyWire) -> Self {
        let mut segments = [SegmentUncertainty::default(); SEGMENTS];
        for (i, (segment, (contact_percent, variances))) in segments.iter_mut().zip(wire.segments).enumerate() {
            let is_set = |mask: u8| mask >> i & 1 == 1;
            let [theta, end @ ..] = variances.map(i32::from_le_bytes);
            *segment = SegmentUncertainty {
                theta: is_set(wire.theta_known).then_some(theta),
                end: is_set(wire.end_known).then_some(end),
                contact_percent,
                in_contact: is_set(wire.in_contact),
            };
        }
        Self { tick: u32::from_le_bytes(wire.tick), segments }
    }
}

/// Bit i is set where the i-th value is there.
fn mask<T>(values: &[Option<T>]) -> u32 {
    values.iter().rev().fold(0, |mask, value| mask << 1 | u32::from(value.is_some()))
}

/// The values whose bit is set.
fn present<T: Copy, const N: usize>(mask: u32, values: [T; N]) -> [Option<T>; N] {
    let mut values = values.into_iter();
    array::from_fn(|i| values.next().filter(|_| mask >> i & 1 == 1))
}
