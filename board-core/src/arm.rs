//! The estimator between the sensors and the line: samples in, estimates out, and when it starts anew.

use estimator_core::{ArmConfig, Estimator, Q};
use telemetry::{Estimate, Event, SEGMENTS, Sample, Uncertainty};

/// Ticks of 10 ms until the first tare if an IMU does not come up.
pub const TARE_TICKS: u32 = 200;

/// Values of the anchor's window that there is room for.
const WINDOW: usize = 100;

/// The estimator, and how often it has started.
///
/// It is large: make it as a static, and [start](Self::start) it there.
#[derive(Debug)]
pub struct Arm {
    estimator: Estimator<'static, Q, SEGMENTS, WINDOW>,
    tare: u8,
    tared: bool,
    /// The contact that was told last, a bit a segment.
    touched: u32,
}

impl Arm {
    /// Not started: it estimates nothing.
    pub const fn new(table: &'static ArmConfig<'static, Q>) -> Self {
        Self { estimator: Estimator::const_new(table), tare: 0, tared: false, touched: 0 }
    }

    /// Starts the estimator at boot. A table that has more segments or a longer window than there is room for gives no
    /// estimate; the samples go out all the same.
    pub fn start(&mut self) {
        // The firmware's build has checked the table; were it wrong, estimates would be empty, and the host sees it.
        let _ = self.estimator.start();
    }

    /// Starts the estimator anew, with the next sample: the arm is in its reference pose.
    pub fn tare(&mut self) {
        self.start();
        self.tare = self.tare.wrapping_add(1);
        self.tared = true;
    }

    /// Whether it is time for the first tare. IMUs come up a second after the board; the samples before say nothing of
    /// their zero.
    pub fn is_due(&self, tick: u32, all_imus_read: bool) -> bool {
        !self.tared && (all_imus_read || tick >= TARE_TICKS)
    }

    /// How often it has been tared, as samples carry it.
    pub const fn tares(&self) -> u8 {
        self.tare
    }

    /// What the sample says of the arm.
    pub fn step(&mut self, sample: &Sample) -> Estimate {
        Estimate::of(sample.tick, self.estimator.update(&sample.into()))
    }

    /// Contact, where it has begun or ended with the newest sample, which was that of this tick.
    pub fn contact(&mut self, tick: u32) -> Option<Event> {
        let touched = self.estimator.contact_mask();
        let has_changed = core::mem::replace(&mut self.touched, touched) != touched;
        has_changed.then(|| Event::Contact(tick, core::array::from_fn(|i| touched >> i & 1 != 0)))
    }

    /// How far the newest estimate, which was that of this tick, may be off, as worked out within the last ticks.
    pub fn uncertainty(&self, tick: u32) -> Uncertainty {
        Uncertainty::of(tick, &self.estimator.uncertainties(), &self.estimator.contacts())
    }
}
