//! Bend angles as a scalar remainder and whole turns.

use core::f64::consts::TAU;

use crate::numeric::phase::Turns;
use crate::numeric::scalar::{Scalar, TWO_PI};

/// A bend angle θ = `remainder` + 2π·`whole_turns`, rad, clockwise positive: a remainder and whole turns.
///
/// Only IMU angles have whole turns, once they have drifted past 180°: raw angles, and corrected angles without an
/// anchor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle<S> {
    /// The angle without its whole turns, rad.
    pub remainder: S,
    /// Number of whole turns.
    pub whole_turns: i32,
}

impl<S: Scalar> Angle<S> {
    /// The whole angle as one scalar, rad; it saturates where `S` does ([`Q`](crate::Q): ±32 rad).
    #[must_use]
    pub fn value(self) -> S {
        if self.whole_turns == 0 {
            self.remainder
        } else {
            self.remainder + S::constant(TWO_PI) * S::from_int(self.whole_turns)
        }
    }

    /// The whole angle as a float, rad. For reports.
    #[must_use]
    pub fn rad(self) -> f64 {
        self.remainder.to_f64() + TAU * f64::from(self.whole_turns)
    }
}

impl<S: Scalar> From<Turns> for Angle<S> {
    fn from(turns: Turns) -> Self {
        Self { remainder: S::from_phase(turns.phase()), whole_turns: turns.whole_turns() }
    }
}

impl<S> From<S> for Angle<S> {
    fn from(rad: S) -> Self {
        Self { remainder: rad, whole_turns: 0 }
    }
}
