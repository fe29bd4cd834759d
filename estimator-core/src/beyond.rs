//! What goes beyond the paper, of one segment: the observer's drift correction, and what tells of contact.
//!
//! All of it works on values, means of the samples since the value before, at the anchor's pace. The values of all segments
//! are complete at once, but each segment has its turn to work on its own, so that no sample costs much more than another.

use core::ops::Range;

use crate::anchor::Slot;
use crate::angle::Turns;
use crate::contact::Touch;
use crate::hysteresis::Memory;
use crate::observer::{Disagreement, Observer};
use crate::scalar::Scalar;
use crate::table::{Segment, Table};
use crate::uncertainty::lever;

/// What is remembered of one segment beyond the paper's method.
#[derive(Debug, Clone)]
pub(crate) struct Beyond<S> {
    pub memory: Memory<S>,
    pub observer: Observer,
    /// Since the newest value,
    growing: Sums,
    /// and of that value.
    complete: Sums,
    /// When it is worked on, as a phase of the [`Pace`](crate::Pace).
    turn: u32,
    pub touch: Touch,
    /// Whether θ_c and θ_bend were there in the newest sample.
    pub seen: Seen,
    /// As [`Spread::step`](crate::Spread::step) takes it.
    pub lever: S,
}

/// θ_imu and θ_bend over the samples of a value that have both.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    imu: Turns,
    bend: Turns,
    count: i32,
}

/// Which of a segment's two angles a sample has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Seen {
    pub imu: bool,
    pub bend: bool,
}

impl<S: Scalar> Beyond<S> {
    /// Of the segment with this place in the table.
    pub fn new(place: usize, segment: &Segment<S>, table: &Table<S>) -> Self {
        let share = table.anchor.sample_rate_millihertz / (table.segments.len() as u32).max(1);
        Self {
            memory: Memory::new(segment.hysteresis),
            observer: table.observer.as_ref().map_or_else(Observer::idle, Observer::new),
            growing: Sums::default(),
            complete: Sums::default(),
            turn: share * place as u32,
            touch: Touch::new(),
            seen: Seen { imu: false, bend: false },
            lever: lever(segment),
        }
    }

    /// Takes one sample's θ_imu and θ_bend, where both are known.
    #[inline]
    pub fn add(&mut self, slot: Slot, both: Option<(Turns, Turns)>) {
        if let Some((imu, bend)) = both {
            let Sums { imu: of_imu, bend: of_bend, count } = self.growing;
            self.growing = Sums { imu: of_imu + imu, bend: of_bend + bend, count: count + 1 };
        }
        if slot.is_complete() {
            self.complete = core::mem::take(&mut self.growing);
        }
    }

    /// Whether these phases are the segment's turn.
    pub fn is_due(&self, phases: &Range<u32>) -> bool {
        phases.contains(&self.turn)
    }

    /// The newest value, where there is one.
    pub fn value(&self) -> Option<Disagreement> {
        let Sums { imu, bend, count } = self.complete;
        let mean = |sum: Turns| sum.mean_of(count as u16);
        (count != 0).then(|| Disagreement { imu: mean(imu), bend: mean(bend) })
    }
}
