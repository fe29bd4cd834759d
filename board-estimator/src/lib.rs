//! The estimator between sensors and telemetry: samples in, estimates out; the first tare and each later restart.
//!
//! It is a crate of its own, as the firmware builds it for speed and the rest of the board's work for size. The restart and what is
//! read of the estimator are `inline`: the firmware compiles them with their callers, for size, which saves 4 kB of flash.
#![no_std]

use estimator_core::{ArmConfig, Estimator, Q};
use heapless::Vec;
use telemetry::{Conditions, Estimate, Event, MAX_SEGMENTS, Sample, Uncertainty, vector};

/// Ticks of 10 ms until the first tare if an IMU does not start.
pub const TARE_TICKS: u32 = 200;

/// Capacity of the anchor's moving-average window, samples.
pub const WINDOW: usize = 100;

/// Ticks of 10 ms from one comparison of the conditions to the next, so that one that comes and goes does not fill the line.
const CONDITION_TICKS: u32 = 10;

/// Sensors that were read and whose readings the estimator leaves out: bit i is set for bend sensor or IMU i.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Implausible {
    /// Bend sensors: 1a, 1b, 2a, …
    pub bend: u16,
    /// IMUs, from the base.
    pub imu: u8,
}

/// The estimator and its tare epoch.
///
/// It is large: make it as a static, and [start](Self::start) it there.
#[derive(Debug)]
pub struct BoardEstimator {
    estimator: Estimator<'static, Q, MAX_SEGMENTS, WINDOW>,
    segments: usize,
    tare_epoch: u8,
    tared: bool,
    /// The arm was not in its reference pose before the last tare, by its estimate.
    is_bent_before_tare: bool,
    /// Contact that was reported last, one bit per segment.
    contact_mask: u32,
    /// Conditions of each segment that were reported last.
    conditions: [Conditions; MAX_SEGMENTS],
}

impl BoardEstimator {
    /// An estimator that is not started and estimates nothing. Without segments in `table` it never estimates.
    pub const fn new(table: &'static ArmConfig<'static, Q>) -> Self {
        Self {
            estimator: Estimator::const_new(table),
            segments: table.segments.len(),
            tare_epoch: 0,
            tared: false,
            is_bent_before_tare: false,
            contact_mask: 0,
            conditions: [Conditions(0); MAX_SEGMENTS],
        }
    }

    /// Starts the estimator at boot. A table with more segments or a longer window than the capacity gives no estimate;
    /// samples are sent all the same.
    #[inline]
    pub fn start(&mut self) {
        // The table was checked when it was stored and read; the table of a board without one has no segments.
        let _ = self.estimator.start();
    }

    /// Restarts the estimator with the next sample: the arm is in its reference pose.
    #[inline]
    pub fn tare(&mut self) {
        self.is_bent_before_tare = self.tared && self.estimator.is_off_reference();
        self.start();
        self.tare_epoch = self.tare_epoch.wrapping_add(1);
        self.tared = true;
    }

    /// Returns whether the first tare is due. IMUs start a second after the board; samples before that do not contain
    /// their zero.
    pub fn needs_first_tare(&self, tick: u32, all_imus_read: bool) -> bool {
        !self.tared && (all_imus_read || tick >= TARE_TICKS)
    }

    /// Number of tares since boot, modulo 256, as in [`Sample::tare_epoch`].
    pub const fn tare_epoch(&self) -> u8 {
        self.tare_epoch
    }

    /// Updates the estimator with a sample and returns the new estimate.
    pub fn update(&mut self, sample: &Sample) -> Estimate {
        Estimate::of(sample.tick, self.estimator.update(&sample.into()))
    }

    /// Sensors whose readings in the latest sample are left out.
    #[inline]
    pub fn implausible(&self) -> Implausible {
        let mut implausible = Implausible::default();
        for (segment, condition) in self.estimator.conditions().iter().enumerate() {
            let [a, b] = condition.bend_implausible.map(u16::from);
            implausible.bend |= (a | b << 1) << (2 * segment);
            implausible.imu |= u8::from(condition.imu_implausible) << segment;
        }
        implausible
    }

    /// Conditions of each segment's estimate.
    #[inline]
    pub fn conditions(&self) -> Vec<Conditions, MAX_SEGMENTS> {
        let of_tare = if self.is_bent_before_tare { Conditions::BENT_BEFORE_TARE } else { Conditions(0) };
        vector(self.estimator.conditions().iter().map(|condition| Conditions::from(*condition) | of_tare))
    }

    /// Reports the segments whose conditions have changed since they were reported last; compared every tenth tick.
    pub fn condition_events(&mut self, tick: u32, mut report: impl FnMut(Event)) {
        if !tick.is_multiple_of(CONDITION_TICKS) {
            return;
        }
        for ((segment, now), reported) in (0..).zip(&self.conditions()).zip(&mut self.conditions) {
            if core::mem::replace(reported, *now) != *now {
                report(Event::Condition(segment, *now));
            }
        }
    }

    /// Segment, counted from 0, with the largest bend angle by its bend sensors in the latest sample, and that angle in units
    /// of 2⁻²⁶ rad; `None`: no bend sensor was read.
    pub fn most_bent(&self) -> Option<(u8, i32)> {
        let angles = (0..).zip(self.estimator.bend_angles());
        let angles = angles.filter_map(|(segment, angle)| angle.map(|angle| (segment, angle.to_bits())));
        angles.max_by_key(|(_, angle)| angle.unsigned_abs())
    }

    /// Returns an event if contact began or ended with the latest sample, which was that of this tick.
    pub fn contact_event(&mut self, tick: u32) -> Option<Event> {
        let mask = self.estimator.contact_mask();
        let has_changed = core::mem::replace(&mut self.contact_mask, mask) != mask;
        has_changed.then_some(Event::Contact(tick, mask as u8))
    }

    /// Covariance of the latest estimate, which was that of this tick, as computed within the last ticks.
    #[inline]
    pub fn uncertainty(&self, tick: u32) -> Uncertainty {
        Uncertainty::of(tick, self.segments, &self.estimator.uncertainties(), &self.estimator.contacts())
    }
}
