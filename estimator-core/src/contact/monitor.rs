//! Contact detection of the whole arm: means of the samples at the anchor's rate, staggered over the segments.
//!
//! The values of all segments are complete in the same sample; each segment is processed in a sample of its own, so
//! that the load is even.

use crate::config::{ArmConfig, ContactConfig, CoupledSegment, SegmentConfig};
use crate::contact::coupling::CouplingModel;
use crate::contact::detector::{ContactDetector, Residual, Thresholds};
use crate::drift::correction::MeasuredAngles;
use crate::drift::decimator::{Decimated, Decimator};
use crate::numeric::phase::Turns;
use crate::types::{Condition, Contact, Contacts};

/// Contact detectors of up to `N` segments.
#[derive(Debug, Clone)]
pub struct ContactMonitor<const N: usize> {
    segments: [SegmentMonitor; N],
    has_value: bool,
}

/// Detectors of one segment, and their input.
#[derive(Debug, Clone, Copy)]
struct SegmentMonitor {
    accumulating: Sums,
    latest: Sums,
    /// Steps of θ_c in the newest sample of the latest value, in units of 2⁻³² turns.
    steps: i32,
    /// θ of the IMUs when the segment was last processed, in units of 2⁻³² turns.
    imu: Option<i32>,
    coupling: CouplingModel,
    detector: ContactDetector,
}

/// Sums of the angles over the samples of one value.
#[derive(Debug, Clone, Copy)]
struct Sums {
    imu: Sum,
    bend: Sum,
}

#[derive(Debug, Clone, Copy)]
struct Sum {
    sum: Turns,
    count: u16,
}

impl Sums {
    const EMPTY: Self = Self { imu: Sum::EMPTY, bend: Sum::EMPTY };
}

impl Sum {
    const EMPTY: Self = Self { sum: Turns::ZERO, count: 0 };

    fn add(&mut self, angle: Option<Turns>) {
        if let Some(angle) = angle {
            self.sum = self.sum + angle;
            self.count = self.count.saturating_add(1);
        }
    }

    /// The mean, in units of 2⁻³² turns.
    fn mean(&self) -> Option<i32> {
        (self.count > 0).then(|| self.sum.mean_of(self.count).bits() as i32)
    }
}

impl<const N: usize> ContactMonitor<N> {
    /// At the start of a session.
    pub const fn new() -> Self {
        Self { segments: [SegmentMonitor::new(); N], has_value: false }
    }

    /// Clears all state, part by part: a temporary of the whole would not fit a small stack.
    pub fn start(&mut self) {
        for segment in &mut self.segments {
            *segment = SegmentMonitor::new();
        }
        self.has_value = false;
    }

    /// Updates the detectors with one sample's angles. Sensors that a segment's `condition` reports as faulty are
    /// excluded.
    pub fn update<S>(
        &mut self,
        config: &ArmConfig<S>,
        thresholds: &ContactConfig,
        decimator: Decimator,
        decimated: Decimated,
        angles: &[MeasuredAngles; N],
        condition: impl Fn(usize) -> Condition,
    ) {
        for (segment, angles) in self.segments.iter_mut().zip(angles) {
            segment.accumulating.imu.add(angles.imu);
            segment.accumulating.bend.add(angles.bend);
            if decimated.is_complete() {
                segment.latest = core::mem::replace(&mut segment.accumulating, Sums::EMPTY);
                segment.steps = angles.steps.bits() as i32;
            }
        }
        self.has_value |= decimated.is_complete();
        if !self.has_value {
            return;
        }
        let stagger = decimator.stagger(&config.anchor, decimated);
        let share = config.anchor.sample_rate_millihertz / (config.segments.len() as u32).max(1);
        for (i, segment) in config.segments.iter().enumerate().take(N) {
            if stagger.contains(&(share * i as u32)) {
                self.detect(i, segment, thresholds, &condition);
            }
        }
    }

    /// Processes segment `i`, after the segment that it is coupled to.
    fn detect<S>(
        &mut self,
        i: usize,
        segment: &SegmentConfig<S>,
        thresholds: &ContactConfig,
        condition: &impl Fn(usize) -> Condition,
    ) {
        let own = condition(i);
        let below_restarted = i.checked_sub(1).is_some_and(|below| condition(below).imu_restarted);
        let coupled = segment.coupled_to.and_then(|coupled| {
            let other = self.segments.get(usize::from(coupled.segment))?;
            Some((coupled, other.imu, other.steps))
        });
        let Some(monitor) = self.segments.get_mut(i) else { return };
        monitor.imu = monitor.latest.imu.mean().filter(|_| !own.imu_restarted && !below_restarted);
        let (imu, bend) = (monitor.imu, monitor.latest.bend.mean().filter(|_| !own.bend_distrusted));
        let by_bend = imu.zip(bend).map(|(imu, bend)| (imu.wrapping_sub(bend), bend));
        let by_bend = by_bend.map(|(residual, angle)| Residual { residual, angle });
        let Some(limits) = &segment.contact else {
            monitor.detect_by_thresholds(thresholds, by_bend, coupled);
            return;
        };
        if let Some(limit) = &limits.bend {
            monitor.detector.update_bend(Thresholds::of_limit(limit), by_bend);
        }
        if let Some(((coupled, lead, steps), coupling)) = coupled.zip(limits.coupling.as_ref()) {
            let model = &mut monitor.coupling;
            let value = imu.zip(lead).map(|(own, lead)| model.update(coupled, coupling, own, lead, steps));
            monitor.detector.update_coupling(Thresholds::of_limit(&coupling.limit), value);
        }
    }

    /// Bit mask of the segments in contact; bit 0 is the first segment.
    pub fn contact_mask<S>(&self, segments: &[SegmentConfig<S>]) -> u32 {
        let mut mask = 0;
        for (i, (monitor, segment)) in self.segments.iter().zip(segments).enumerate() {
            mask |= u32::from(monitor.detector.bend().in_contact) << i;
            if monitor.detector.coupling().in_contact {
                let other = segment.coupled_to.map_or(0, |coupled| 1_u32.wrapping_shl(coupled.segment.into()));
                mask |= 1 << i | other;
            }
        }
        mask
    }

    /// Contact and score of each segment.
    pub fn contacts<S>(&self, segments: &[SegmentConfig<S>]) -> Contacts<N> {
        let mask = self.contact_mask(segments);
        let mut contacts = Contacts::new();
        for i in 0..segments.len() {
            let _ = contacts.push(Contact { score_percent: 0, in_contact: mask >> i & 1 != 0 });
        }
        for (i, (monitor, segment)) in self.segments.iter().zip(segments).enumerate() {
            let [bend, coupling] =
                [monitor.detector.bend(), monitor.detector.coupling()].map(|contact| contact.score_percent);
            let other = segment.coupled_to.map(|coupled| usize::from(coupled.segment));
            for (place, score) in [(Some(i), bend.max(coupling)), (other, coupling)] {
                if let Some(contact) = place.and_then(|place| contacts.get_mut(place)) {
                    contact.score_percent = contact.score_percent.max(score);
                }
            }
        }
        contacts
    }
}

impl SegmentMonitor {
    const fn new() -> Self {
        Self {
            accumulating: Sums::EMPTY,
            latest: Sums::EMPTY,
            steps: 0,
            imu: None,
            coupling: CouplingModel::new(),
            detector: ContactDetector::new(),
        }
    }

    /// Processes a segment without limits of its own: θ_c against the bend sensors, and against that of the coupled
    /// segment.
    fn detect_by_thresholds(
        &mut self,
        thresholds: &ContactConfig,
        by_bend: Option<Residual>,
        coupled: Option<(CoupledSegment, Option<i32>, i32)>,
    ) {
        let by_bend = by_bend.map(|value| Residual { residual: value.residual.wrapping_add(self.steps), ..value });
        self.detector.update_bend(Thresholds::of_bend(thresholds), by_bend);
        if let Some((coupled, lead, lead_steps)) = coupled {
            let both =
                self.imu.zip(lead).map(|(own, lead)| [own.wrapping_add(self.steps), lead.wrapping_add(lead_steps)]);
            let value = both.map(|[own, lead]| Residual { residual: coupled.residual(own, lead), angle: 0 });
            self.detector.update_coupling(Thresholds::of_coupling(thresholds), value);
        }
    }
}
