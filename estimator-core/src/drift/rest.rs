//! Detector of rest (zero angular rate): while the whole arm is at rest, the change of a heading is its drift.
//!
//! Every five seconds the headings and bend angles are compared with those of five seconds ago. After twenty seconds of
//! rest the change of a heading over time is a measurement of the bias's rate, and the shape is held: the bias follows
//! the heading.

use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Constant, Scalar, TIME_UNIT_S};
use crate::numeric::variance::{degrees, magnitude};

/// Length of a window, µs.
const WINDOW_US: u64 = 5_000_000;
/// Time of rest after which the rates are measured and the shape is held, µs: creep has settled.
const HOLD_US: u64 = 19_500_000;
/// Time constant of the means, time units: half a second, a 128th.
const MEAN_TIME: Constant = Constant::new(0.5 / TIME_UNIT_S);
/// Largest change of a heading in a window, and range of its readings: 0.15 °/s, plus 0.5° of noise for the range.
const HEADING_CHANGE: Constant = degrees(0.75);
const HEADING_RANGE: Constant = degrees(1.25);
/// Largest change of a bend angle in a window.
const BEND_CHANGE: Constant = degrees(0.8);

/// Detector of rest for up to `N` segments.
#[derive(Debug, Clone, Copy)]
pub struct RestDetector<S, const N: usize> {
    headings: [Mean<S>; N],
    bend: [Mean<S>; N],
    window_from_us: Option<u64>,
    quiet_us: u64,
}

/// Deviation of a signal from its value at the beginning of the window.
#[derive(Debug, Clone, Copy)]
struct Mean<S> {
    start: Option<Turns>,
    filtered: S,
    lowest: S,
    highest: S,
    /// At least one value was read in this window.
    is_read: bool,
}

/// Changes over a window of rest.
#[derive(Debug, Clone, Copy)]
pub struct RestWindow<S, const N: usize> {
    /// Change of each heading as the IMU reads it, rad; `None` where it was not read.
    pub headings: [Option<S>; N],
    /// Change of each bend angle, rad; zero where it was not read.
    pub bend: [S; N],
    /// Length of the window, µs.
    pub length_us: u64,
    /// Time for which the arm has rested at its end, µs.
    pub rested_us: u64,
}

impl<S: Scalar> Mean<S> {
    const fn new(zero: S) -> Self {
        Self { start: None, filtered: zero, lowest: zero, highest: zero, is_read: false }
    }

    /// Adds a value; `share` is its weight in the mean.
    fn add(&mut self, value: Turns, share: S) {
        self.is_read = true;
        let start = *self.start.get_or_insert(value);
        let deviation = S::from_phase((value - start).phase());
        self.filtered += share * (deviation - self.filtered);
        self.lowest = if deviation < self.lowest { deviation } else { self.lowest };
        self.highest = if deviation > self.highest { deviation } else { self.highest };
    }

    /// Ends the window: returns the change of the mean and the range of the values; the next window begins at the mean.
    fn finish(&mut self) -> Option<(S, S)> {
        let start = self.start.filter(|_| self.is_read)?;
        let (change, range) = (self.filtered, self.highest - self.lowest);
        *self = Self { start: Some(start + change.to_turns()), ..Self::new(S::zero()) };
        Some((change, range))
    }
}

impl<S: Scalar, const N: usize> RestDetector<S, N> {
    /// At the start of a session.
    pub const fn new(zero: S) -> Self {
        Self { headings: [Mean::new(zero); N], bend: [Mean::new(zero); N], window_from_us: None, quiet_us: 0 }
    }

    /// Returns `true` while the shape is held.
    pub fn is_resting(&self) -> bool {
        self.quiet_us >= HOLD_US
    }

    /// Adds the readings of IMU and segment `i`, `dt` after the last ones: the uncorrected heading, and the bend angle.
    pub fn update(&mut self, i: usize, heading: Option<Turns>, bend: Option<Turns>, dt: S) {
        // In two steps, as 128 does not fit the fixed-point range.
        let share = if dt < S::constant(MEAN_TIME) { dt * S::from_int(16) * S::from_int(8) } else { S::one() };
        for (means, value) in [(&mut self.headings, heading), (&mut self.bend, bend)] {
            if let (Some(mean), Some(value)) = (means.get_mut(i), value) {
                mean.add(value, share);
            }
        }
    }

    /// Changes over a window of rest, at its end.
    pub fn window(&mut self, time_us: u64) -> Option<RestWindow<S, N>> {
        let from_us = *self.window_from_us.get_or_insert(time_us);
        let length_us = time_us.saturating_sub(from_us);
        if length_us < WINDOW_US {
            return None;
        }
        self.window_from_us = Some(time_us);
        self.finish(length_us)
    }

    fn finish(&mut self, length_us: u64) -> Option<RestWindow<S, N>> {
        // A gap may hide motion.
        let mut is_quiet = length_us < WINDOW_US + WINDOW_US / 8;
        let mut headings = [None; N];
        for (change, mean) in headings.iter_mut().zip(&mut self.headings) {
            if let Some((moved, range)) = mean.finish() {
                is_quiet &= magnitude(moved) < S::constant(HEADING_CHANGE) && range < S::constant(HEADING_RANGE);
                *change = Some(moved);
            }
        }
        let mut bend = [S::zero(); N];
        for (change, mean) in bend.iter_mut().zip(&mut self.bend) {
            if let Some((moved, _)) = mean.finish() {
                is_quiet &= magnitude(moved) < S::constant(BEND_CHANGE);
                *change = moved;
            }
        }
        self.quiet_us = if is_quiet { self.quiet_us.saturating_add(length_us) } else { 0 };
        self.is_resting().then_some(RestWindow { headings, bend, length_us, rested_us: self.quiet_us })
    }
}

#[cfg(test)]
mod tests;
