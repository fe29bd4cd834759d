//! The estimator between the sensors and the line: samples in, estimates out, and when it starts anew.

use estimator_core::{Estimator, Q};
use telemetry::{Estimate, SEGMENTS, Sample};

use crate::parameters::TARE_TICKS;
use crate::table::TABLE;

/// Values of the anchor's window that there is room for.
const WINDOW: usize = 100;

/// The estimator, and how often it has started.
pub struct Arm {
    estimator: Option<Estimator<'static, Q, SEGMENTS, WINDOW>>,
    tare: u8,
    started: bool,
}

impl Arm {
    /// At boot. A table that does not fit the firmware gives no estimate; the samples go out all the same.
    pub fn new() -> Self {
        Self { estimator: Estimator::new(&TABLE).ok(), tare: 0, started: false }
    }

    /// Starts the estimator anew, with the next sample: the arm is in its reference pose.
    pub fn tare(&mut self) {
        self.estimator = Estimator::new(&TABLE).ok();
        self.tare = self.tare.wrapping_add(1);
        self.started = true;
    }

    /// Whether it is time for the first tare. IMUs come up a second after the board; the samples before say nothing of
    /// their zero.
    pub fn is_due(&self, tick: u32, all_imus_read: bool) -> bool {
        !self.started && (all_imus_read || tick >= TARE_TICKS)
    }

    /// How often it has been tared, as samples carry it.
    pub const fn tares(&self) -> u8 {
        self.tare
    }

    /// What the sample says of the arm.
    pub fn step(&mut self, sample: &Sample) -> Option<Estimate> {
        let estimator = self.estimator.as_mut()?;
        let readings = sample.into();
        let estimate = estimator.step(&readings);
        Some(Estimate::of(sample.tick, &estimator.shape(&estimate, estimator_core::Method::Fusion)))
    }
}
