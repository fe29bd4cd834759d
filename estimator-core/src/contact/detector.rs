//! Contact detector: fast changes of residuals that a free arm does not make.
//!
//! Free, coupled segments bend coupled, and the bend sensors of a segment follow its IMUs, up to the share of the motion that
//! hysteresis keeps. A push or an obstacle breaks both within half a second: it bends one segment and not the coupled one,
//! and it bends it unevenly, which constant curvature cannot explain. Slow changes are drift and hysteresis.

use crate::config::{ContactConfig, CoupledSegment};
use crate::numeric::phase::Turns;
use crate::types::Contact;

/// Window of the change, values: half a second at 10 Hz.
const WINDOW: usize = 5;

/// Contact times out after so many values (a minute at 10 Hz); the residual then becomes the new baseline.
const TIMEOUT: u16 = 600;

/// Share of its motion that a segment's hysteresis may keep, as a right shift.
const HYSTERESIS_SHIFT: u32 = 2;

impl CoupledSegment {
    /// θ less what the coupling expects of it, in units of 2⁻³² turns.
    pub(crate) fn residual(self, theta: i32, other: i32) -> i32 {
        theta.wrapping_sub(((i64::from(self.ratio) * i64::from(other)) >> 28) as i32)
    }
}

/// Detectors of one segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactDetector {
    bend: ChangeDetector,
    coupling: ChangeDetector,
    /// θ_c of the newest value, in units of 2⁻³² turns.
    pub theta: Option<i32>,
}

impl ContactDetector {
    pub const fn new() -> Self {
        Self { bend: ChangeDetector::new(), coupling: ChangeDetector::new(), theta: None }
    }

    /// Takes one value of θ_c and θ_bend.
    #[inline(never)]
    pub fn update(&mut self, rule: &ContactConfig, value: Option<(Turns, Turns)>) {
        let value = value.map(|(corrected, bend)| (corrected.bits() as i32, bend.bits() as i32));
        self.theta = value.map(|(corrected, _)| corrected);
        let value = value.map(|(corrected, bend)| Residual { residual: corrected.wrapping_sub(bend), angle: bend });
        self.bend.update(Thresholds { change: rule.bend.bits() as u32, hysteresis_shift: HYSTERESIS_SHIFT }, value);
    }

    /// Takes one value of the residual against the coupled segment, where both are known.
    #[inline(never)]
    pub fn update_pair(&mut self, rule: &ContactConfig, difference: Option<i32>) {
        let value = difference.map(|residual| Residual { residual, angle: 0 });
        self.coupling.update(Thresholds { change: rule.coupling.bits() as u32, hysteresis_shift: 31 }, value);
    }

    /// Contact by the segment's own sensors.
    pub const fn bend(&self) -> Contact {
        self.bend.contact
    }

    /// Contact of the segment or the coupled one.
    pub const fn coupling(&self) -> Contact {
        self.coupling.contact
    }
}

/// Detector of a fast change of one residual. Angles are in units of 2⁻³² turns.
#[derive(Debug, Clone, Copy)]
struct ChangeDetector {
    /// Ring buffer of the latest residuals, its length and head.
    recent: [Residual; WINDOW],
    len: u8,
    head: u8,
    active: Option<ActiveContact>,
    contact: Contact,
}

/// A residual, and the angle whose motion explains a part of it.
#[derive(Debug, Clone, Copy)]
struct Residual {
    residual: i32,
    angle: i32,
}

/// An active contact.
#[derive(Debug, Clone, Copy)]
struct ActiveContact {
    /// The residual before it.
    from: i32,
    values: u16,
}

/// Thresholds of a detector.
#[derive(Debug, Clone, Copy)]
struct Thresholds {
    /// Change of the residual, in units of 2⁻³² turns.
    change: u32,
    /// Share of the motion that is taken off the change, as a right shift.
    hysteresis_shift: u32,
}

impl ChangeDetector {
    const fn new() -> Self {
        Self {
            recent: [Residual { residual: 0, angle: 0 }; WINDOW],
            len: 0,
            head: 0,
            active: None,
            contact: Contact { score_percent: 0, in_contact: false },
        }
    }

    /// Takes one value. Nothing is concluded over a missing one.
    fn update(&mut self, limits: Thresholds, value: Option<Residual>) {
        let score_percent = value.map_or(0, |value| self.score(limits, value));
        if value.is_none() {
            self.len = 0;
        }
        self.contact = Contact { score_percent, in_contact: self.active.is_some() };
    }

    fn score(&mut self, limits: Thresholds, value: Residual) -> u16 {
        let Some(place) = self.recent.get_mut(usize::from(self.head)) else { return 0 };
        let before = core::mem::replace(place, value);
        self.head = if usize::from(self.head) + 1 < WINDOW { self.head + 1 } else { 0 };
        let is_known = usize::from(self.len) == WINDOW;
        let score_percent = if is_known { limits.percent(before, value) } else { 0 };
        self.len += u8::from(!is_known);
        self.active = match self.active {
            None if score_percent > 100 => Some(ActiveContact { from: before.residual, values: 0 }),
            Some(departure) if departure.lasts(limits, value) => {
                Some(ActiveContact { values: departure.values + 1, ..departure })
            }
            Some(_) => {
                // Its end is as fast as its beginning, and is not a new contact.
                self.len = 0;
                None
            }
            None => None,
        };
        score_percent
    }
}

impl ActiveContact {
    /// Whether it lasts: until the residual is back where it was, or near zero.
    fn lasts(self, limits: Thresholds, value: Residual) -> bool {
        let half = limits.change / 2;
        let away = value.residual.wrapping_sub(self.from).unsigned_abs();
        away > half && value.residual.unsigned_abs() > half && self.values < TIMEOUT
    }
}

impl Thresholds {
    fn percent(self, before: Residual, now: Residual) -> u16 {
        let change = now.residual.wrapping_sub(before.residual).unsigned_abs();
        let motion = now.angle.wrapping_sub(before.angle).unsigned_abs();
        let rest = change.saturating_sub(motion >> self.hysteresis_shift);
        // 2²⁴ steps are a 256th of a turn, and times 100 in range.
        ((rest >> 8) * 100 / ((self.change >> 8) | 1)).min(u32::from(u16::MAX)) as u16
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::{ChangeDetector, CoupledSegment, Residual, TIMEOUT, Thresholds};

    /// 4° and 1°, in units of 2⁻³² turns.
    const LIMIT: u32 = 47_721_859;
    const DEGREE: i32 = 11_930_465;

    const COUPLING: Thresholds = Thresholds { change: LIMIT, hysteresis_shift: 31 };
    const BEND: Thresholds = Thresholds { change: LIMIT, hysteresis_shift: 2 };

    /// Whether each of the residuals, in degrees, is seen as contact; the segment moves as they do, tenfold.
    fn touched(limits: Thresholds, degrees: impl IntoIterator<Item = i32>) -> Vec<bool> {
        let mut detector = ChangeDetector::new();
        let step = |degrees: i32| {
            let angle = (degrees * DEGREE).wrapping_mul(10);
            detector.update(limits, Some(Residual { residual: degrees * DEGREE, angle }));
            detector.contact.in_contact
        };
        degrees.into_iter().map(step).collect()
    }

    #[test]
    fn a_push_is_seen_within_half_a_second_and_until_it_goes() {
        let push = [0, 0, 0, 0, 0, 0, 2, 5, 9, 12, 13, 13, 13, 13, 12, 9, 5, 1, 0, 0, 0, 0, 0, 0];
        let seen = touched(COUPLING, push);
        assert_eq!(seen.iter().position(|seen| *seen), Some(7));
        assert_eq!(seen.iter().rposition(|seen| *seen), Some(16));
        assert!(seen[7..=16].iter().all(|seen| *seen));
    }

    #[test]
    fn slow_changes_are_none() {
        assert!(!touched(COUPLING, (0..100).map(|k| k / 2)).contains(&true));
    }

    #[test]
    fn motion_excuses_what_hysteresis_keeps() {
        let quick = || (0..40).map(|k| 2 * k % 150);
        assert!(touched(COUPLING, quick()).contains(&true));
        assert!(!touched(BEND, quick()).contains(&true));
    }

    #[test]
    fn a_residual_that_stays_is_no_contact_for_ever() {
        let seen = touched(COUPLING, [0; 10].into_iter().chain([20; TIMEOUT as usize + 20]));
        assert!(seen[10] && !seen[seen.len() - 1]);
    }

    #[test]
    fn nothing_is_concluded_over_a_gap() {
        let mut detector = ChangeDetector::new();
        let at = |degrees: i32| Some(Residual { residual: degrees * DEGREE, angle: 0 });
        for value in [at(0), at(0), at(0), at(0), at(0), at(0), None, at(20), at(20), at(20), at(20), at(20), at(20)] {
            detector.update(COUPLING, value);
            assert!(!detector.contact.in_contact);
        }
    }

    #[test]
    fn what_bends_by_its_share_of_the_like_differs_by_nothing() {
        let coupled = CoupledSegment { segment: 0, ratio: (-0.75 * CoupledSegment::ONE) as i32 };
        assert_eq!(coupled.residual(-3 * DEGREE, 4 * DEGREE), 0);
        assert_eq!(coupled.residual(5 * DEGREE, -4 * DEGREE), 2 * DEGREE);
    }
}
