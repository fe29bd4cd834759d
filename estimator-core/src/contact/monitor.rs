//! Contact detection of the whole arm: means of the samples at the anchor's rate, one segment in its turn.
//!
//! The values of all segments are complete at once, but each segment is worked on in its own turn, so that no sample costs
//! much more than another.

use crate::config::{ArmConfig, ContactConfig, SegmentConfig};
use crate::contact::detector::ContactDetector;
use crate::drift::decimator::{Decimated, Decimator};
use crate::numeric::phase::Turns;
use crate::types::{Contact, Contacts};

/// Contact detectors of up to `N` segments.
#[derive(Debug, Clone)]
pub struct ContactMonitor<const N: usize> {
    segments: [SegmentMonitor; N],
    has_value: bool,
}

/// One segment's detectors, and the means that they work on.
#[derive(Debug, Clone, Copy)]
struct SegmentMonitor {
    accumulating: Sums,
    latest: Sums,
    detector: ContactDetector,
}

/// θ_c and θ_bend over the samples of a value that have both.
#[derive(Debug, Clone, Copy)]
struct Sums {
    corrected: Turns,
    bend: Turns,
    count: u16,
}

impl Sums {
    const EMPTY: Self = Self { corrected: Turns::ZERO, bend: Turns::ZERO, count: 0 };

    fn add(&mut self, corrected: Turns, bend: Turns) {
        self.corrected = self.corrected + corrected;
        self.bend = self.bend + bend;
        self.count = self.count.saturating_add(1);
    }

    fn means(&self) -> Option<(Turns, Turns)> {
        (self.count > 0).then(|| (self.corrected.mean_of(self.count), self.bend.mean_of(self.count)))
    }
}

impl<const N: usize> ContactMonitor<N> {
    /// At the start of a session.
    pub const fn new() -> Self {
        let segment =
            SegmentMonitor { accumulating: Sums::EMPTY, latest: Sums::EMPTY, detector: ContactDetector::new() };
        Self { segments: [segment; N], has_value: false }
    }

    /// Takes one sample's θ_c and θ_bend of each segment, where both are known.
    pub fn update<S>(
        &mut self,
        config: &ArmConfig<S>,
        thresholds: &ContactConfig,
        decimator: Decimator,
        decimated: Decimated,
        angles: &[Option<(Turns, Turns)>; N],
    ) {
        for (segment, angles) in self.segments.iter_mut().zip(angles) {
            if let Some((corrected, bend)) = angles {
                segment.accumulating.add(*corrected, *bend);
            }
            if decimated.is_complete() {
                segment.latest = core::mem::replace(&mut segment.accumulating, Sums::EMPTY);
            }
        }
        self.has_value |= decimated.is_complete();
        if !self.has_value {
            return;
        }
        let phases = decimator.phases(&config.anchor, decimated);
        let share = config.anchor.sample_rate_millihertz / (config.segments.len() as u32).max(1);
        for (i, segment) in config.segments.iter().enumerate().take(N) {
            if phases.contains(&(share * i as u32)) {
                self.detect(i, segment, thresholds);
            }
        }
    }

    /// The turn of segment `i`, which comes after that of the segment that it is coupled to.
    fn detect<S>(&mut self, i: usize, segment: &SegmentConfig<S>, thresholds: &ContactConfig) {
        let other = segment.coupled_to.and_then(|coupled| self.segments.get(usize::from(coupled.segment)));
        let other = other.and_then(|other| other.detector.theta);
        let Some(SegmentMonitor { latest, detector, .. }) = self.segments.get_mut(i) else { return };
        detector.update(thresholds, latest.means());
        if let Some(coupled) = segment.coupled_to {
            let residual = detector.theta.zip(other).map(|(theta, other)| coupled.residual(theta, other));
            detector.update_pair(thresholds, residual);
        }
    }

    /// A bit for each segment in contact, the first in the lowest place.
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
