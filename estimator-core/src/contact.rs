//! Contact: what a free arm does not do.
//!
//! Free, the segments of one actuator bend alike, and the bend sensors of a segment read what its IMUs say, up to a share
//! of the motion that hysteresis keeps. A push or an obstacle breaks both within half a second: it bends one segment and
//! not its like, and it bends it unevenly, which constant curvature cannot explain. Either disagreement is watched for a
//! quick change; slow ones are drift and hysteresis.

/// Values that a change is looked for over: half a second at 10 Hz.
const SPAN: usize = 5;

/// A contact that does not go away is the new way of things after so many values: a minute at 10 Hz.
const LONGEST: u16 = 600;

/// One disagreement, watched for a quick change. Angles are in units of 2⁻³² turns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    /// The newest values, round and round; how many there are, and which is the oldest.
    recent: [Value; SPAN],
    known: u8,
    oldest: u8,
    touch: Option<Touch>,
}

/// A disagreement, and the angle whose motion excuses a part of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value {
    pub disagreement: i32,
    pub angle: i32,
}

/// A contact that is going on.
#[derive(Debug, Clone, Copy)]
struct Touch {
    /// The disagreement before it.
    before: i32,
    values: u16,
}

/// What is no contact yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Limits {
    /// Change of the disagreement, in units of 2⁻³² turns.
    pub change: u32,
    /// Share of the motion that is taken off the change, as a right shift; 32: none.
    pub excuse: u32,
}

impl Watch {
    pub const fn new() -> Self {
        Self { recent: [Value { disagreement: 0, angle: 0 }; SPAN], known: 0, oldest: 0, touch: None }
    }

    /// Takes one value; gives the change over [`SPAN`] values in percent of the limit. A missing value leaves a gap that
    /// nothing is concluded over.
    pub fn step(&mut self, limits: Limits, value: Option<Value>) -> u16 {
        let Some(value) = value else {
            self.known = 0;
            return 0;
        };
        let Some(place) = self.recent.get_mut(usize::from(self.oldest)) else { return 0 };
        let before = core::mem::replace(place, value);
        self.oldest = if usize::from(self.oldest) + 1 < SPAN { self.oldest + 1 } else { 0 };
        let is_known = usize::from(self.known) == SPAN;
        let score = if is_known { percent(limits, before, value) } else { 0 };
        if !is_known {
            self.known += 1;
        }
        self.touch = match self.touch {
            None if score > 100 => Some(Touch { before: before.disagreement, values: 0 }),
            Some(touch) if touch.lasts(limits, value) => Some(Touch { values: touch.values + 1, ..touch }),
            Some(_) => {
                // Its end is as quick as its beginning, and none.
                self.known = 0;
                None
            }
            None => None,
        };
        score
    }

    /// Whether something touches the segment.
    pub const fn is_touched(&self) -> bool {
        self.touch.is_some()
    }
}

impl Touch {
    /// Until the disagreement is what it was, or none.
    fn lasts(self, limits: Limits, value: Value) -> bool {
        let half = limits.change / 2;
        let away = value.disagreement.wrapping_sub(self.before).unsigned_abs();
        away > half && value.disagreement.unsigned_abs() > half && self.values < LONGEST
    }
}

fn percent(limits: Limits, before: Value, now: Value) -> u16 {
    let change = now.disagreement.wrapping_sub(before.disagreement).unsigned_abs();
    let motion = now.angle.wrapping_sub(before.angle).unsigned_abs();
    let rest = change.saturating_sub(motion.checked_shr(limits.excuse).unwrap_or(0));
    ((rest >> 8) * 100 / ((limits.change >> 8) | 1)).min(u32::from(u16::MAX)) as u16
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::{LONGEST, Limits, Value, Watch};

    /// 4° and 1°, in units of 2⁻³² turns.
    const LIMIT: u32 = 47_721_859;
    const DEGREE: i32 = 11_930_465;

    const PAIR: Limits = Limits { change: LIMIT, excuse: 32 };
    const BEND: Limits = Limits { change: LIMIT, excuse: 2 };

    /// Whether each of the disagreements, in degrees, is seen as contact; the segment moves as they do, tenfold.
    fn touched(limits: Limits, degrees: impl IntoIterator<Item = i32>) -> Vec<bool> {
        let mut watch = Watch::new();
        let step = |degrees: i32| {
            watch.step(
                limits,
                Some(Value { disagreement: degrees * DEGREE, angle: (degrees * DEGREE).wrapping_mul(10) }),
            );
            watch.is_touched()
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
            assert!(!watch.is_touched());
        }
    }
}
