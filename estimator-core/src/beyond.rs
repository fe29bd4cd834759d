//! What goes beyond the paper, of one segment: the observer's drift correction, and what tells of contact.
//!
//! All of it works on values, means of the samples since the value before, at the anchor's pace.

use crate::anchor::{Mean, Slot};
use crate::angle::Turns;
use crate::contact::Touch;
use crate::hysteresis::Memory;
use crate::observer::{Disagreement, Observer, ObserverRule};
use crate::scalar::Scalar;
use crate::table::Segment;
use crate::uncertainty::lever;

/// What is remembered of one segment beyond the paper's method.
#[derive(Debug, Clone)]
pub(crate) struct Beyond<S> {
    pub memory: Memory<S>,
    pub observer: Observer,
    /// θ_imu and θ_bend since the value before, over the samples that have both.
    means: [Mean; 2],
    pub touch: Touch,
    /// Whether θ_c and θ_bend were there in the newest sample.
    pub seen: Seen,
    /// As [`Spread::step`](crate::Spread::step) takes it.
    pub lever: S,
}

/// Which of a segment's two angles a sample has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Seen {
    pub imu: bool,
    pub bend: bool,
}

impl<S: Scalar> Beyond<S> {
    pub fn new(segment: &Segment<S>, observer: Option<&ObserverRule>) -> Self {
        Self {
            memory: Memory::new(segment.hysteresis),
            observer: observer.map_or_else(Observer::idle, Observer::new),
            means: [Mean::EMPTY; 2],
            touch: Touch::new(),
            seen: Seen { imu: false, bend: false },
            lever: lever(segment),
        }
    }

    /// Takes one sample's θ_imu and θ_bend, where both are known; gives the value that it completes.
    #[inline(never)]
    pub fn value(&mut self, slot: Slot, both: Option<(Turns, Turns)>) -> Option<Disagreement> {
        let [imu, bend] = &mut self.means;
        if let Some((of_imu, of_bend)) = both {
            imu.add(of_imu);
            bend.add(of_bend);
        }
        if !slot.is_complete() {
            return None;
        }
        let means = core::mem::replace(&mut self.means, [Mean::EMPTY; 2]).map(Mean::value);
        let [Some(imu), Some(bend)] = means else { return None };
        Some(Disagreement { imu, bend })
    }
}
