//! What a bend sensor remembers of where it came from: a Prandtl–Ishlinskii correction on top of the quadratic map.
//!
//! A play follows its input only when one of its two edges pushes it. The difference of the input and a play says from
//! which side, and how far, the input came; a weighted sum of such differences corrects the bend angle
//! (K. Kuhnen, "Modeling, identification and compensation of complex hysteretic nonlinearities", 2003, eq. 2 and 8).

use crate::scalar::Scalar;

/// Plays of a correction.
pub const PLAYS: usize = 3;

/// One play and its share in the correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Play<S> {
    /// From the middle to either edge, rad.
    pub half_width: S,
    /// Of the difference of input and play.
    pub weight: S,
}

/// A correction of one segment's bend angle: θ + Σ w (θ − play(θ)).
pub type Hysteresis<S> = [Play<S>; PLAYS];

/// A correction and where its plays are: nowhere before the first reading, which sets them all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Memory<S> {
    hysteresis: Option<Hysteresis<S>>,
    places: Option<[S; PLAYS]>,
}

impl<S: Scalar> Memory<S> {
    pub const fn new(hysteresis: Option<Hysteresis<S>>) -> Self {
        Self { hysteresis, places: None }
    }

    /// The corrected angle.
    #[inline(never)]
    pub fn correct(&mut self, theta: S) -> S {
        let Some(hysteresis) = &self.hysteresis else { return theta };
        let places = self.places.get_or_insert([theta; PLAYS]);
        let plays: [_; PLAYS] = core::array::from_fn(|k| {
            let Play { half_width, weight } = hysteresis[k];
            let ahead = theta - places[k];
            let ahead = if ahead.is_within(half_width) {
                ahead
            } else if ahead < S::zero() {
                -half_width
            } else {
                half_width
            };
            places[k] = theta - ahead;
            (weight, ahead)
        });
        theta + S::dot(plays.map(|(weight, _)| weight), plays.map(|(_, ahead)| ahead))
    }
}

#[cfg(test)]
mod tests {
    use super::{Memory, Play};

    const ONE: [Play<f64>; 3] = [
        Play { half_width: 0.1, weight: 0.5 },
        Play { half_width: 0.0, weight: 1.0 },
        Play { half_width: 1.0, weight: 0.0 },
    ];

    fn corrected(thetas: &[f64]) -> Vec<f64> {
        let mut memory = Memory::new(Some(ONE));
        thetas.iter().map(|theta| memory.correct(*theta)).collect()
    }

    extern crate std;
    use std::vec::Vec;

    #[test]
    fn the_first_reading_is_left_alone() {
        assert_eq!(corrected(&[0.7]), [0.7]);
    }

    #[test]
    fn the_same_angle_is_corrected_by_the_side_that_it_is_come_to_from() {
        let [.., from_below] = corrected(&[0.0, 0.5])[..] else { panic!() };
        let [.., from_above] = corrected(&[1.0, 0.5])[..] else { panic!() };
        // The play of 0.1 is at its edge: half of it to either side.
        assert!((from_below - 0.55).abs() < 1e-12 && (from_above - 0.45).abs() < 1e-12);
    }

    #[test]
    fn inside_a_play_the_memory_stays() {
        let seen = corrected(&[0.0, 0.5, 0.45, 0.5]);
        assert!((seen[3] - seen[1]).abs() < 1e-12 && (seen[2] - 0.475).abs() < 1e-12, "{seen:?}");
    }
}
