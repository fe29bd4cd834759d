//! Plausibility of one IMU's heading: jumps, restarts with another zero, returns after an absence, and frozen output.
//!
//! A reading is compared with the heading that its segment's bend sensors predict from the heading below. A reading
//! that deviates too far is rejected; if the deviation persists, the IMU has a new zero, and the deviation is added to
//! its bias.

use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar};
use crate::numeric::variance::{degrees, magnitude};

/// Limit of a reading's deviation, plus the bend sensors' motion since the last sample. Half the limit holds while a
/// jump is suspected.
const JUMP: Constant = degrees(6.0);
/// Factor on that motion after an absence.
const RETURN_PER_MOTION: Constant = Constant::new(0.3);
/// Limit of the deviation without bend sensors.
const JUMP_UNSEEN: Constant = degrees(30.0);
/// Absence after which an IMU may have restarted.
const ABSENCE_US: u64 = 500_000;
/// Time for which a heading must deviate until a new zero is assumed; outliers are shorter.
const CONFIRMATION_US: u64 = 350_000;
/// Output that is constant to the bit for this time, while the bend sensors move, is frozen.
const FROZEN_US: u64 = 990_000;

/// State of one IMU's plausibility check.
#[derive(Debug, Clone, Copy)]
pub struct HeadingGate<S> {
    /// Last accepted reading, unwrapped, and the same corrected for the gyroscope's scale error.
    raw: Turns,
    scaled: Turns,
    accepted_at_us: Option<u64>,
    /// Times of the first and the last rejected reading since the last accepted one, µs.
    suspect_us: Option<[u64; 2]>,
    /// Headings are absolute: the first reading needs no tare.
    is_absolute: bool,
    freeze: Freeze<S>,
}

/// The newest change of the reading, and the bend angles at that time.
#[derive(Debug, Clone, Copy)]
struct Freeze<S> {
    reading: Turns,
    since_us: u64,
    theta: S,
    bend: Option<S>,
    is_frozen: bool,
}

/// Prediction of one heading.
#[derive(Debug, Clone, Copy)]
pub struct HeadingPrediction<S> {
    /// Heading that the bend sensors predict in {W}.
    pub heading: Turns,
    /// Motion of the bend sensors since the last sample, rad.
    pub motion: S,
    /// Bias of the heading.
    pub bias: Turns,
    /// θ of the segment after the last sample, rad.
    pub theta: S,
    /// θ_bend of the segment, where it is known, rad.
    pub bend: Option<S>,
    /// Motion of the bend sensors during which an IMU must change, rad.
    pub frozen_motion: S,
}

/// Verdict on one reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict<S> {
    /// The heading in {W}.
    Accepted(Turns),
    /// The heading in {W} after an absence, in which the IMU may have restarted near its old zero.
    Returned(Turns),
    /// The IMU has a new zero: angle to add to its bias, and duration of the absence before it, µs.
    Restarted(Turns, u64),
    /// Not read, or not used.
    Absent,
    /// Frozen: θ of the segment by its bend sensors since the IMU's last change, rad.
    Frozen(S),
}

impl<S: Scalar> HeadingGate<S> {
    /// Before the first reading.
    pub const fn new(zero: S) -> Self {
        let freeze = Freeze { reading: Turns::ZERO, since_us: 0, theta: zero, bend: None, is_frozen: false };
        Self {
            raw: Turns::ZERO,
            scaled: Turns::ZERO,
            accepted_at_us: None,
            suspect_us: None,
            is_absolute: false,
            freeze,
        }
    }

    /// Sets the zero at the end of a tare: the newest reading, unwrapped, and its heading in {W}.
    pub fn tare(&mut self, raw: Turns, heading: Turns, time_us: u64) {
        *self = Self { raw, scaled: heading, accepted_at_us: Some(time_us), ..Self::new(S::zero()) };
    }

    /// Waits for the first reading of an IMU whose headings are absolute.
    pub fn expect_absolute(&mut self) {
        *self = Self { is_absolute: true, ..Self::new(S::zero()) };
    }

    /// Checks a reading, unwrapped, or `None` where the IMU was not read. `scale_error` is the gyroscope's, in units of
    /// 2⁻³². `above` returns the deviation of the next IMU's reading from the same prediction, where it was read.
    pub fn check(
        &mut self,
        reading: Option<Turns>,
        scale_error: i32,
        expected: &HeadingPrediction<S>,
        above: impl Fn() -> Option<Turns>,
        time_us: u64,
    ) -> Verdict<S> {
        let Some(reading) = reading else { return Verdict::Absent };
        let Some(accepted_at_us) = self.accepted_at_us else {
            if self.is_absolute {
                let deviation = Turns::from((reading - expected.bias - expected.heading).phase());
                self.accept(reading, expected.heading + expected.bias + deviation, time_us);
                return Verdict::Accepted(expected.heading + deviation);
            }
            // First read after the tare: its zero is unknown.
            self.accept(reading, expected.heading + expected.bias, time_us);
            return Verdict::Restarted(Turns::ZERO, ABSENCE_US);
        };
        let deviation = self.deviation(reading, scale_error, expected.heading + expected.bias);
        let absence_us = time_us.saturating_sub(accepted_at_us);
        let is_far =
            self.is_far(deviation, expected, above, absence_us) && !self.was_late(deviation, reading, expected);
        if let Some(theta) = self.frozen_theta(reading, expected, time_us) {
            return Verdict::Frozen(theta);
        }
        if is_far {
            if time_us.saturating_sub(self.suspect_since(time_us)) < CONFIRMATION_US {
                return Verdict::Absent;
            }
            self.accept(reading, expected.heading + expected.bias + deviation, time_us);
            return Verdict::Restarted(deviation, absence_us);
        }
        self.accept(reading, expected.heading + expected.bias + deviation, time_us);
        let heading = expected.heading + deviation;
        if absence_us > ABSENCE_US { Verdict::Returned(heading) } else { Verdict::Accepted(heading) }
    }

    fn accept(&mut self, reading: Turns, scaled: Turns, time_us: u64) {
        (self.raw, self.scaled) = (reading, scaled);
        (self.accepted_at_us, self.suspect_us) = (Some(time_us), None);
    }

    /// Time of the first of the rejected readings up to this one; those before an absence do not count.
    fn suspect_since(&mut self, time_us: u64) -> u64 {
        let recent = self.suspect_us.filter(|[_, last_us]| time_us.saturating_sub(*last_us) <= ABSENCE_US);
        let since_us = recent.map_or(time_us, |[since_us, _]| since_us);
        self.suspect_us = Some([since_us, time_us]);
        since_us
    }

    /// Returns `true` if a deviation is larger than the possible motion of the arm.
    fn is_far(
        &self,
        deviation: Turns,
        expected: &HeadingPrediction<S>,
        above: impl Fn() -> Option<Turns>,
        absence_us: u64,
    ) -> bool {
        let moved = magnitude(expected.motion);
        let limit = if expected.bend.is_none() {
            S::constant(JUMP_UNSEEN)
        } else if absence_us > ABSENCE_US {
            S::constant(JUMP) + S::constant(RETURN_PER_MOTION) * moved
        } else {
            S::constant(JUMP) + moved
        };
        let limit = if self.suspect_us.is_some() { limit.half() } else { limit };
        // If the next IMU deviates equally, the segment has moved (a push that the bend sensors miss), and the IMU is
        // good.
        !is_within(deviation, limit) && !above().is_some_and(|above| is_within(above - deviation, limit.half()))
    }

    /// Returns `true` if a deviation is the motion of the bend sensors while the output stood still, too short to be
    /// frozen: θ has followed the old output since.
    fn was_late(&self, deviation: Turns, reading: Turns, expected: &HeadingPrediction<S>) -> bool {
        let Freeze { theta, bend, .. } = self.freeze;
        let Some((bend, start)) = expected.bend.zip(bend) else { return false };
        let missed = theta + bend - start - (expected.theta + expected.motion);
        reading != self.freeze.reading && is_within(deviation - missed.to_turns(), S::constant(JUMP))
    }

    /// Deviation of a reading from a predicted one (heading and bias), without whole turns.
    pub fn deviation(&self, reading: Turns, scale_error: i32, predicted: Turns) -> Turns {
        let delta = reading - self.raw;
        let scaled = self.scaled + delta - delta.scaled_by(scale_error);
        Turns::from((scaled - predicted).phase())
    }

    /// Returns `true` if a reading was accepted before, so that a deviation is defined.
    pub fn is_known(&self) -> bool {
        self.accepted_at_us.is_some()
    }

    /// θ by the bend sensors if the output has not changed by a bit while they have moved.
    fn frozen_theta(&mut self, reading: Turns, expected: &HeadingPrediction<S>, time_us: u64) -> Option<S> {
        let freeze = &mut self.freeze;
        if reading != freeze.reading || freeze.bend.is_none() {
            let theta = expected.theta + expected.motion;
            *freeze = Freeze { reading, since_us: time_us, theta, bend: expected.bend, is_frozen: false };
            return None;
        }
        // Without bend sensors the state does not change.
        let motion = expected.bend.zip(freeze.bend).map(|(bend, start)| bend - start);
        let is_old = time_us.saturating_sub(freeze.since_us) >= FROZEN_US;
        freeze.is_frozen |= is_old && motion.is_some_and(|motion| magnitude(motion) > expected.frozen_motion);
        freeze.is_frozen.then(|| motion.map_or(expected.theta, |motion| freeze.theta + motion))
    }
}

/// Returns `true` if an angle is within ±`limit`.
fn is_within<S: Scalar>(angle: Turns, limit: S) -> bool {
    magnitude(S::from_phase(angle.phase())) <= limit
}

#[cfg(test)]
mod tests;
