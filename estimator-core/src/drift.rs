//! The drift correction of one segment: the paper's anchor, or the observer.

use crate::anchor::{Anchor, AnchorRule, Mean, Slot};
use crate::angle::Turns;
use crate::observer::{Disagreement, Observer, ObserverRule};

/// One segment's angles in one sample.
pub(crate) struct Reading {
    /// θ_imu before the tare is subtracted.
    pub imu: Option<Turns>,
    /// What to subtract from it; `None` until the tare is complete.
    pub zero: Option<Turns>,
    /// θ_bend.
    pub bend: Option<Turns>,
}

/// What is known of one segment's drift.
#[derive(Debug, Clone)]
pub(crate) enum Drift<'t, const W: usize> {
    Anchor(&'t AnchorRule, Anchor<W>),
    Observer(&'t ObserverRule, Observer, Means),
}

/// θ_imu and θ_bend since the value before, over the samples that have both.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Means {
    imu: Mean,
    bend: Mean,
}

impl<'t, const W: usize> Drift<'t, W> {
    pub const fn new(anchor: &'t AnchorRule, observer: Option<&'t ObserverRule>) -> Self {
        match observer {
            None => Self::Anchor(anchor, Anchor::new()),
            Some(rule) => Self::Observer(rule, Observer::new(rule), Means::EMPTY),
        }
    }

    /// Takes one sample; gives what to subtract from the tared θ_imu, if anything.
    #[inline]
    pub fn offset(&mut self, slot: Slot, Reading { imu, zero, bend }: Reading) -> Option<Turns> {
        match self {
            Self::Anchor(rule, anchor) => {
                anchor.push(slot, imu.zip(bend).map(|(imu, bend)| imu - bend));
                anchor.offset().zip(zero).map(|(offset, zero)| offset - zero).filter(|o| o.exceeds(rule.threshold))
            }
            Self::Observer(rule, observer, means) => {
                let zero = zero?;
                if let Some((imu, bend)) = imu.zip(bend) {
                    means.add(imu - zero, bend);
                }
                if slot.complete {
                    observer.step(rule, means.take(), false);
                }
                Some(observer.bias())
            }
        }
    }
}

impl Means {
    const EMPTY: Self = Self { imu: Mean::EMPTY, bend: Mean::EMPTY };

    fn add(&mut self, imu: Turns, bend: Turns) {
        self.imu.add(imu);
        self.bend.add(bend);
    }

    /// The means, and begins anew; `None` where there is nothing to take the mean of.
    fn take(&mut self) -> Option<Disagreement> {
        let Self { imu, bend } = core::mem::replace(self, Self::EMPTY);
        imu.value().zip(bend.value()).map(|(imu, bend)| Disagreement { imu, bend })
    }
}
