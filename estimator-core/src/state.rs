//! What is remembered of one segment, and what a sample does to it.

use core::ops::Range;

use nalgebra::SVector;

use crate::anchor::{Anchor, Slot};
use crate::angle::{Angle, Turns};
use crate::bend::BendMap;
use crate::beyond::Beyond;
use crate::estimator::{Fused, SegmentEstimate};
use crate::filter::{Block, Gains};
use crate::imu::Heading;
use crate::pcc::{Link, Pcc};
use crate::sample::SENSORS_PER_SEGMENT;
use crate::scalar::Scalar;
use crate::table::{Segment, Table};

/// What is remembered of one segment, in this order: behind the anchor's long window a load would need its address first.
#[derive(Debug, Clone)]
#[repr(C)]
pub(crate) struct State<S, const W: usize> {
    pub heading: Heading<S>,
    pub maps: [Option<BendMap<S>>; SENSORS_PER_SEGMENT],
    pub pcc: Pcc<S>,
    pub coord: Block<S, 2>,
    pub coord_gains: Gains<S>,
    pub orient: Block<S, 1>,
    pub orient_gains: Gains<S>,
    pub anchor: Anchor<W>,
    pub beyond: Beyond<S>,
}

/// The bend angles that one sample says of one segment.
pub(crate) struct Thetas<S> {
    pub bend: Option<S>,
    pub imu_o: Option<Angle<S>>,
    pub imu_c: Option<Angle<S>>,
    pub bend_sensors_read: u8,
    pub imu_read: bool,
}

/// θ_bend,i, the mean of the segment's sensors that were read, and their number.
#[expect(clippy::inline_always, reason = "measured")]
#[inline(always)]
pub(crate) fn bend_angle<S: Scalar>(
    maps: &[Option<BendMap<S>>; SENSORS_PER_SEGMENT],
    counts: [Option<u16>; SENSORS_PER_SEGMENT],
) -> (Option<S>, u8) {
    let ([map_a, map_b], [counts_a, counts_b]) = (maps, counts);
    // Branch by branch, so that no flags are kept where both are read.
    let Some(a) = read(map_a.as_ref(), counts_a) else {
        let b = read(map_b.as_ref(), counts_b);
        return (b, u8::from(b.is_some()));
    };
    match read(map_b.as_ref(), counts_b) {
        Some(b) => (Some((a + b).half()), 2),
        None => (Some(a), 1),
    }
}

/// What one sensor says, where the segment has it and it was read.
#[expect(clippy::inline_always, reason = "measured")]
#[inline(always)]
fn read<S: Scalar>(map: Option<&BendMap<S>>, counts: Option<u16>) -> Option<S> {
    map?.angle(counts?)
}

impl<S: Scalar, const W: usize> State<S, W> {
    pub fn new(place: usize, segment: &Segment<S>, table: &Table<S>) -> Self {
        Self {
            heading: Heading::new(table.tare_samples, segment.reference),
            maps: segment.bend,
            anchor: Anchor::new(),
            pcc: Pcc::new(segment),
            orient: Block::new(),
            coord: Block::new(),
            orient_gains: Gains::new(&segment.orient),
            coord_gains: Gains::new(&segment.coord),
            beyond: Beyond::new(place, segment, table),
        }
    }

    /// θ_c by whatever the table asks for: θ_imu is the first of the two less the second, which is its zero.
    #[inline(never)]
    pub fn corrected(
        &mut self,
        table: &Table<S>,
        slot: Slot,
        phases: &Range<u32>,
        [difference, zero]: [Option<Turns>; 2],
        bend: Option<Turns>,
    ) -> Option<Turns> {
        let Self { anchor, beyond, .. } = self;
        let theta_imu = difference.zip(zero).map(|(imu, zero)| imu - zero);
        beyond.add(slot, theta_imu.zip(bend));
        let value = beyond.is_due(phases).then(|| beyond.value());
        let offset = if let Some(rule) = &table.observer {
            if let Some(value) = value {
                beyond.observer.step(rule, value);
            }
            beyond.observer.bias()
        } else {
            anchor.push(slot, difference.zip(bend).map(|(imu, bend)| imu - bend));
            zero.map(|zero| anchor.zero(&table.anchor, zero) - zero).unwrap_or_default()
        };
        if let Some((rule, value)) = table.contact.as_ref().zip(value) {
            beyond.touch.feel(rule, value.map(|value| (value.imu - offset, value.bend)));
        }
        theta_imu.map(|theta| theta - offset)
    }

    /// KF_orient and KF_coord, with the angles that there are; of θ_c without its whole turns, which say nothing of the bend
    /// of a segment that nothing anchors, and fixed point ends at 32 rad. Out of line, with all registers for itself.
    #[inline(never)]
    pub fn fuse(&mut self, theta_c: Option<S>, theta_bend: Option<S>) {
        // Mostly both are there, and there the compiler leaves out all choice between them.
        if theta_c.is_some() && theta_bend.is_some() {
            self.filter(theta_c, theta_bend);
        } else {
            self.filter_without(theta_c, theta_bend);
        }
    }

    #[cold]
    #[inline(never)]
    fn filter_without(&mut self, theta_c: Option<S>, theta_bend: Option<S>) {
        self.filter(theta_c, theta_bend);
    }

    #[expect(clippy::inline_always, reason = "measured")]
    #[inline(always)]
    fn filter(&mut self, theta_c: Option<S>, theta_bend: Option<S>) {
        let end = |theta: S| self.pcc.link(Angle::from(theta)).end;
        self.coord.step(&self.coord_gains, theta_c.map(end), theta_bend.map(end));
        let vector = |theta: S| SVector::from([theta]);
        self.orient.step(&self.orient_gains, theta_c.map(vector), theta_bend.map(vector));
    }

    /// What there is to say of one segment, its filters after this sample.
    pub fn estimate(&self, thetas: &Thetas<S>) -> SegmentEstimate<S> {
        SegmentEstimate {
            bend: thetas.bend.map(|theta| self.pcc.link(Angle::from(theta))),
            imu_o: thetas.imu_o,
            imu_c: thetas.imu_c.map(|theta| self.pcc.link(theta)),
            fusion: self.fused(),
            bend_sensors_read: thetas.bend_sensors_read,
            imu_read: thetas.imu_read,
        }
    }

    /// What the filters say now.
    #[inline]
    pub fn fused(&self) -> Option<Fused<S>> {
        let ((theta, theta_variance), (end, end_variance)) = self.orient.state().zip(self.coord.state())?;
        Some(Fused { link: Link { theta: Angle::from(theta.x), end }, theta_variance, end_variance })
    }
}
