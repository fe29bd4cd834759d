//! Contact: what a free arm does not do.
//!
//! Free, the segments of one actuator bend alike, and the bend sensors of a segment read what its IMUs say, up to a share
//! of the motion that hysteresis keeps. A push or an obstacle breaks both within half a second: it bends one segment and
//! not its like, and it bends it unevenly, which constant curvature cannot explain. Either disagreement is watched for a
//! quick change; slow ones are drift and hysteresis.

use crate::angle::Turns;

/// Values that a change is looked for over: half a second at 10 Hz.
const SPAN: usize = 5;

/// A contact that does not go away is the new way of things after so many values: a minute at 10 Hz.
const LONGEST: u16 = 600;

/// Share of its motion that a segment's hysteresis may keep, as a right shift.
const KEPT: u32 = 2;

/// Changes within half a second that a free arm does not make.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContactRule {
    /// Of a segment's IMUs against its bend sensors, a quarter of the motion taken off.
    pub bend: Turns,
    /// Of a segment against the one that bends alike.
    pub alike: Turns,
}

/// An earlier segment that bends alike, in free motion: θ = ratio · θ of that one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alike {
    /// Its place in the table, from 0.
    pub segment: u8,
    /// In units of 2⁻²⁸, within ±8.
    pub ratio: i32,
}

impl Alike {
    /// One in the units of the ratio.
    pub const ONE: f64 = 268_435_456.0;

    /// What `theta` differs by from what that of the other tells.
    pub(crate) fn difference(self, theta: i32, other: i32) -> i32 {
        theta.wrapping_sub(((i64::from(self.ratio) * i64::from(other)) >> 28) as i32)
    }
}

/// Whether something touches a segment, and how sure that is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Contact {
    /// The largest change within half a second, in percent of what a free arm does not exceed.
    pub score_percent: u16,
    /// From a score over 100 on, until the change is undone, or for a minute.
    pub is_touched: bool,
}

/// What touches the segments, from the base to the tip.
pub type Contacts<const N: usize> = heapless::Vec<Contact, N>;

/// What is watched of one segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    bend: Watch,
    alike: Watch,
    /// θ_c of the newest value, in units of 2⁻³² turns.
    pub theta: Option<i32>,
}

impl Touch {
    pub const fn new() -> Self {
        Self { bend: Watch::new(), alike: Watch::new(), theta: None }
    }

    /// Takes a value of the segment's own: θ_c and θ_bend.
    #[inline(never)]
    pub fn feel(&mut self, rule: &ContactRule, value: Option<(Turns, Turns)>) {
        let value = value.map(|(corrected, bend)| (corrected.bits() as i32, bend.bits() as i32));
        self.theta = value.map(|(corrected, _)| corrected);
        let value = value.map(|(corrected, bend)| Value { disagreement: corrected.wrapping_sub(bend), angle: bend });
        self.bend.step(Limits { change: rule.bend.bits() as u32, kept: KEPT }, value);
    }

    /// Takes what the segment differs by from its like, where both are known.
    #[inline(never)]
    pub fn compare(&mut self, rule: &ContactRule, difference: Option<i32>) {
        let value = difference.map(|disagreement| Value { disagreement, angle: 0 });
        self.alike.step(Limits { change: rule.alike.bits() as u32, kept: 31 }, value);
    }

    /// What the segment's own sensors tell.
    pub const fn bend(&self) -> Contact {
        self.bend.contact
    }

    /// What the segment and its like tell, of either.
    pub const fn alike(&self) -> Contact {
        self.alike.contact
    }
}

/// One disagreement, watched for a quick change. Angles are in units of 2⁻³² turns.
#[derive(Debug, Clone, Copy)]
struct Watch {
    /// The newest values, round and round; how many there are, and which is the oldest.
    recent: [Value; SPAN],
    known: u8,
    oldest: u8,
    going_on: Option<Departure>,
    contact: Contact,
}

/// A disagreement, and the angle whose motion excuses a part of it.
#[derive(Debug, Clone, Copy)]
struct Value {
    disagreement: i32,
    angle: i32,
}

/// A contact that is going on.
#[derive(Debug, Clone, Copy)]
struct Departure {
    /// The disagreement before it.
    from: i32,
    values: u16,
}

/// What is no contact yet.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Change of the disagreement, in units of 2⁻³² turns.
    change: u32,
    /// Share of the motion that is taken off the change, as a right shift.
    kept: u32,
}

impl Watch {
    const fn new() -> Self {
        Self {
            recent: [Value { disagreement: 0, angle: 0 }; SPAN],
            known: 0,
            oldest: 0,
            going_on: None,
            contact: Contact { score_percent: 0, is_touched: false },
        }
    }

    /// Takes one value. A missing one leaves a gap that nothing is concluded over.
    fn step(&mut self, limits: Limits, value: Option<Value>) {
        let score_percent = value.map_or(0, |value| self.score(limits, value));
        if value.is_none() {
            self.known = 0;
        }
        self.contact = Contact { score_percent, is_touched: self.going_on.is_some() };
    }

    fn score(&mut self, limits: Limits, value: Value) -> u16 {
        let Some(place) = self.recent.get_mut(usize::from(self.oldest)) else { return 0 };
        let before = core::mem::replace(place, value);
        self.oldest = if usize::from(self.oldest) + 1 < SPAN { self.oldest + 1 } else { 0 };
        let is_known = usize::from(self.known) == SPAN;
        let score_percent = if is_known { limits.percent(before, value) } else { 0 };
        self.known += u8::from(!is_known);
        self.going_on = match self.going_on {
            None if score_percent > 100 => Some(Departure { from: before.disagreement, values: 0 }),
            Some(departure) if departure.lasts(limits, value) => {
                Some(Departure { values: departure.values + 1, ..departure })
            }
            Some(_) => {
                // Its end is as quick as its beginning, and none.
                self.known = 0;
                None
            }
            None => None,
        };
        score_percent
    }
}

impl Departure {
    /// Until the disagreement is what it was, or none.
    fn lasts(self, limits: Limits, value: Value) -> bool {
        let half = limits.change / 2;
        let away = value.disagreement.wrapping_sub(self.from).unsigned_abs();
        away > half && value.disagreement.unsigned_abs() > half && self.values < LONGEST
    }
}

impl Limits {
    fn percent(self, before: Value, now: Value) -> u16 {
        let change = now.disagreement.wrapping_sub(before.disagreement).unsigned_abs();
        let motion = now.angle.wrapping_sub(before.angle).unsigned_abs();
        let rest = change.saturating_sub(motion >> self.kept);
        // 2²⁴ steps are a 256th of a turn, and times 100 in range.
        ((rest >> 8) * 100 / ((self.change >> 8) | 1)).min(u32::from(u16::MAX)) as u16
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::{Alike, LONGEST, Limits, Value, Watch};

    /// 4° and 1°, in units of 2⁻³² turns.
    const LIMIT: u32 = 47_721_859;
    const DEGREE: i32 = 11_930_465;

    const PAIR: Limits = Limits { change: LIMIT, kept: 31 };
    const BEND: Limits = Limits { change: LIMIT, kept: 2 };

    /// Whether each of the disagreements, in degrees, is seen as contact; the segment moves as they do, tenfold.
    fn touched(limits: Limits, degrees: impl IntoIterator<Item = i32>) -> Vec<bool> {
        let mut watch = Watch::new();
        let step = |degrees: i32| {
            let angle = (degrees * DEGREE).wrapping_mul(10);
            watch.step(limits, Some(Value { disagreement: degrees * DEGREE, angle }));
            watch.contact.is_touched
        };
        degrees.into_iter().map(step).collect()
    }

    #[test]
    fn a_push_is_seen_within_half_a_second_and_until_it_goes() {
        let push = [0, 0, 0, 0, 0, 0, 2, 5, 9, 12, 13, 13, 13, 13, 12, 9, 5, 1, 0, 0, 0, 0, 0, 0];
        let seen = touched(PAIR, push);
        assert_eq!(seen.iter().position(|seen| *seen), Some(7));
        assert_eq!(seen.iter().rposition(|seen| *seen), Some(16));
        assert!(seen[7..=16].iter().all(|seen| *seen));
    }

    #[test]
    fn slow_changes_are_none() {
        assert!(!touched(PAIR, (0..100).map(|k| k / 2)).contains(&true));
    }

    #[test]
    fn motion_excuses_what_hysteresis_keeps() {
        let quick = || (0..40).map(|k| 2 * k % 150);
        assert!(touched(PAIR, quick()).contains(&true));
        assert!(!touched(BEND, quick()).contains(&true));
    }

    #[test]
    fn a_disagreement_that_stays_is_no_contact_for_ever() {
        let seen = touched(PAIR, [0; 10].into_iter().chain([20; LONGEST as usize + 20]));
        assert!(seen[10] && !seen[seen.len() - 1]);
    }

    #[test]
    fn nothing_is_concluded_over_a_gap() {
        let mut watch = Watch::new();
        let at = |degrees: i32| Some(Value { disagreement: degrees * DEGREE, angle: 0 });
        for value in [at(0), at(0), at(0), at(0), at(0), at(0), None, at(20), at(20), at(20), at(20), at(20), at(20)] {
            watch.step(PAIR, value);
            assert!(!watch.contact.is_touched);
        }
    }

    #[test]
    fn what_bends_by_its_share_of_the_like_differs_by_nothing() {
        let alike = Alike { segment: 0, ratio: (-0.75 * Alike::ONE) as i32 };
        assert_eq!(alike.difference(-3 * DEGREE, 4 * DEGREE), 0);
        assert_eq!(alike.difference(5 * DEGREE, -4 * DEGREE), 2 * DEGREE);
    }
}
