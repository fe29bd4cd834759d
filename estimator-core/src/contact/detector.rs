//! Contact detector: fast changes of residuals that do not occur on a free arm.
//!
//! In free motion, coupled segments bend in proportion, and the bend sensors of a segment agree with its IMUs. A push
//! or an obstacle breaks both within a second: it bends one segment and not the coupled one, and it bends it unevenly,
//! which constant curvature cannot explain. Slow changes are drift and hysteresis. The change over a window is a
//! high-pass filter of the residual; contact begins where it exceeds its threshold in a number of values in a row
//! (debounce).

use crate::config::{ChangeLimit, ContactConfig, CoupledSegment};
use crate::types::Contact;

/// Longest window of the change, values: a second at 10 Hz.
const LONGEST_WINDOW: usize = 10;

/// Window of the motion, and of the change for the arm's thresholds, values.
const SHORT_WINDOW: u8 = 5;

/// Contact times out after this number of values (a minute at 10 Hz); the residual then becomes the new baseline.
const TIMEOUT: u16 = 600;

/// Values in a row over a limit from the calibration sweep at which contact begins.
const DEBOUNCE: u8 = 2;

/// Share of a segment's motion that its hysteresis can retain, as a right shift.
const HYSTERESIS_SHIFT: u32 = 2;

/// Share of the motion in excess of the sweep's that is subtracted from the change, as a right shift.
const EXCESS_SHIFT: u32 = 1;

/// Decay of the largest motion in one value, as a right shift.
const HOLD_SHIFT: u32 = 4;

impl CoupledSegment {
    /// Residual: θ minus its prediction from the coupled segment, in units of 2⁻³² turns.
    pub(crate) fn residual(self, theta: i32, other: i32) -> i32 {
        theta.wrapping_sub(scaled(other, self.ratio))
    }
}

/// `angle` times a ratio in units of 2⁻²⁸.
pub(crate) fn scaled(angle: i32, ratio: i32) -> i32 {
    ((i64::from(ratio) * i64::from(angle)) >> 28) as i32
}

/// Contact detectors of one segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactDetector {
    bend: ChangeDetector,
    coupling: ChangeDetector,
}

impl ContactDetector {
    pub const fn new() -> Self {
        Self { bend: ChangeDetector::new(), coupling: ChangeDetector::new() }
    }

    /// Updates the detector of the IMUs against the bend sensors.
    #[inline(never)]
    pub fn update_bend(&mut self, thresholds: Thresholds, value: Option<Residual>) {
        self.bend.update(thresholds, value);
    }

    /// Updates the detector of the segment against the coupled one.
    #[inline(never)]
    pub fn update_coupling(&mut self, thresholds: Thresholds, value: Option<Residual>) {
        self.coupling.update(thresholds, value);
    }

    /// Contact detected by the segment's own sensors.
    pub const fn bend(&self) -> Contact {
        self.bend.contact
    }

    /// Contact of the segment or of the coupled one.
    pub const fn coupling(&self) -> Contact {
        self.coupling.contact
    }
}

/// Detector of a fast change of one residual. Angles are in units of 2⁻³² turns.
#[derive(Debug, Clone, Copy)]
struct ChangeDetector {
    /// Ring buffer of the latest residuals, its length and head.
    recent: [Residual; LONGEST_WINDOW],
    len: u8,
    head: u8,
    /// Values in a row over the threshold.
    exceeded: u8,
    /// Largest motion within half a second, decaying.
    motion: u32,
    active: Option<ActiveContact>,
    contact: Contact,
}

/// A residual, and the angle whose motion explains a part of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Residual {
    pub residual: i32,
    pub angle: i32,
}

/// An active contact.
#[derive(Debug, Clone, Copy)]
struct ActiveContact {
    /// Residual before the contact.
    from: i32,
    is_rise: bool,
    values: u16,
}

/// Thresholds of a detector.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thresholds {
    /// Change of the residual, in units of 2⁻³² turns.
    change: u32,
    /// Motion up to which nothing is subtracted from the change.
    motion: u32,
    /// Share of the excess motion that is subtracted from the change, as a right shift.
    excess_shift: u32,
    /// Decay of the largest motion in one value, as a right shift; 0: the newest motion alone.
    hold_shift: u32,
    window: u8,
    debounce: u8,
    /// The residual of the free arm is near zero, so that contact ends there.
    has_zero: bool,
}

impl ChangeDetector {
    const fn new() -> Self {
        Self {
            recent: [Residual { residual: 0, angle: 0 }; LONGEST_WINDOW],
            len: 0,
            head: 0,
            exceeded: 0,
            motion: 0,
            active: None,
            contact: Contact { score_percent: 0, in_contact: false },
        }
    }

    /// Updates the detector with one value. A missing value clears the window.
    fn update(&mut self, thresholds: Thresholds, value: Option<Residual>) {
        let score_percent = value.map_or(0, |value| self.score(thresholds, value));
        if value.is_none() {
            (self.len, self.exceeded) = (0, 0);
        }
        self.contact = Contact { score_percent, in_contact: self.active.is_some() };
    }

    fn score(&mut self, thresholds: Thresholds, value: Residual) -> u16 {
        let later = self.head + thresholds.window - SHORT_WINDOW;
        let later = if later < thresholds.window { later } else { later - thresholds.window };
        let Some(half_second_ago) = self.recent.get(usize::from(later)).copied() else { return 0 };
        let Some(place) = self.recent.get_mut(usize::from(self.head)) else { return 0 };
        let before = core::mem::replace(place, value);
        self.head = if self.head + 1 < thresholds.window { self.head + 1 } else { 0 };
        let is_known = self.len == thresholds.window;
        let motion = if is_known { value.angle.wrapping_sub(half_second_ago.angle).unsigned_abs() } else { 0 };
        self.motion = motion.max(self.motion - (self.motion >> thresholds.hold_shift));
        let score_percent = if is_known { thresholds.percent(before, value, self.motion) } else { 0 };
        self.len += u8::from(!is_known);
        self.exceeded = if score_percent > 100 { self.exceeded.saturating_add(1) } else { 0 };
        self.active = match self.active {
            None if self.exceeded >= thresholds.debounce => {
                let is_rise = value.residual.wrapping_sub(before.residual) > 0;
                Some(ActiveContact { from: before.residual, is_rise, values: 0 })
            }
            Some(departure) if departure.lasts(thresholds, value) => {
                Some(ActiveContact { values: departure.values + 1, ..departure })
            }
            Some(_) => {
                // The end of a contact is as fast as its beginning; it must not count as a new contact.
                (self.len, self.exceeded) = (0, 0);
                None
            }
            None => None,
        };
        score_percent
    }
}

impl ActiveContact {
    /// Returns `false` once the residual has returned to its value before the contact, or near zero.
    fn lasts(self, thresholds: Thresholds, value: Residual) -> bool {
        let half = thresholds.change / 2;
        let away = value.residual.wrapping_sub(self.from);
        let departure = if thresholds.has_zero {
            away.unsigned_abs().min(value.residual.unsigned_abs())
        } else if (away > 0) == self.is_rise {
            away.unsigned_abs()
        } else {
            0
        };
        departure > half && self.values < TIMEOUT
    }
}

impl Thresholds {
    /// Thresholds of the arm for the IMUs against the bend sensors.
    pub const fn of_bend(config: &ContactConfig) -> Self {
        let change = config.bend.bits() as u32;
        Self { change, excess_shift: HYSTERESIS_SHIFT, ..Self::of_coupling(config) }
    }

    /// Thresholds of the arm for a segment against the coupled one.
    pub const fn of_coupling(config: &ContactConfig) -> Self {
        Self {
            change: config.coupling.bits() as u32,
            motion: 0,
            excess_shift: 31,
            hold_shift: 0,
            window: SHORT_WINDOW,
            debounce: 1,
            has_zero: true,
        }
    }

    /// Thresholds from the residual's scatter in the calibration sweep.
    pub const fn of_limit(limit: &ChangeLimit) -> Self {
        Self {
            change: limit.change.bits() as u32,
            motion: limit.motion.bits() as u32,
            excess_shift: EXCESS_SHIFT,
            hold_shift: HOLD_SHIFT,
            window: LONGEST_WINDOW as u8,
            debounce: DEBOUNCE,
            has_zero: false,
        }
    }

    fn percent(self, before: Residual, now: Residual, motion: u32) -> u16 {
        let change = now.residual.wrapping_sub(before.residual).unsigned_abs();
        let excess = change.saturating_sub(motion.saturating_sub(self.motion) >> self.excess_shift);
        // 2²⁴ steps are a 256th of a turn, and times 100 in range.
        ((excess >> 8) * 100 / ((self.change >> 8) | 1)).min(u32::from(u16::MAX)) as u16
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::{ChangeDetector, CoupledSegment, Residual, TIMEOUT, Thresholds};
    use crate::config::{ChangeLimit, ContactConfig};
    use crate::numeric::phase::Turns;

    /// 1°, in units of 2⁻³² turns.
    const DEGREE: i32 = 11_930_465;

    /// 4° for either residual.
    const LIMIT: Turns = Turns::from_bits(47_721_859);
    const CONFIG: ContactConfig = ContactConfig { bend: LIMIT, coupling: LIMIT };
    const COUPLING: Thresholds = Thresholds::of_coupling(&CONFIG);
    const BEND: Thresholds = Thresholds::of_bend(&CONFIG);
    /// Thresholds of a sweep that moved by 5° in half a second.
    const SWEPT: Thresholds =
        Thresholds::of_limit(&ChangeLimit { change: LIMIT, motion: Turns::from_bits(5 * DEGREE as i64) });

    /// Contact after each of the residuals, in degrees; the segment moves ten times as far.
    fn touched(thresholds: Thresholds, degrees: impl IntoIterator<Item = i32>) -> Vec<bool> {
        let mut detector = ChangeDetector::new();
        let step = |degrees: i32| {
            let angle = (degrees * DEGREE).wrapping_mul(10);
            detector.update(thresholds, Some(Residual { residual: degrees * DEGREE, angle }));
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

    /// Contact after each residual by [`SWEPT`]; residuals and the segment's angles in degrees.
    fn touched_in_motion(values: impl IntoIterator<Item = [i32; 2]>) -> Vec<bool> {
        let mut detector = ChangeDetector::new();
        let step = |[residual, angle]: [i32; 2]| {
            detector.update(SWEPT, Some(Residual { residual: residual * DEGREE, angle: angle * DEGREE }));
            detector.contact.in_contact
        };
        values.into_iter().map(step).collect()
    }

    #[test]
    fn a_single_wild_value_is_no_contact() {
        let wild = (0..40).map(|k| [if k == 20 { 30 } else { 0 }, 0]);
        assert!(!touched_in_motion(wild).contains(&true));
    }

    #[test]
    fn contact_by_the_sweep_lasts_until_the_residual_returns_from_either_side() {
        for sign in [1, -1] {
            let seen = touched_in_motion((0..60).map(|k| [if (20..40).contains(&k) { 10 * sign } else { -sign }, 0]));
            assert_eq!(seen.iter().position(|seen| *seen), Some(21));
            assert_eq!(seen.iter().rposition(|seen| *seen), Some(39));
        }
    }

    #[test]
    fn motion_beyond_that_of_the_sweep_is_taken_off_the_change() {
        let swing = |speed: i32| (0..40).map(move |k| [k * 3 / 4, speed * k]);
        assert!(touched_in_motion(swing(1)).contains(&true), "7.5° within a second, as the sweep has moved");
        assert!(!touched_in_motion(swing(3)).contains(&true), "the same at three times the sweep's motion");
    }

    #[test]
    fn fast_motion_is_held_over_the_turning_point() {
        let residual = |k: i32| if k < 25 { 0 } else { 6 };
        let turning = |k: i32| [residual(k), if k < 20 { 4 * k } else { 80 }];
        assert!(!touched_in_motion((0..30).map(turning)).contains(&true), "right after 20° within half a second");
        assert!(touched_in_motion((0..40).map(|k| [residual(k), 60])).contains(&true), "at rest");
    }
}
