//! Memory of a bend sensor: play operators (hysteresis) and first-order lags (creep).
//!
//! A play follows its input only when one of its two edges pushes it. The difference of the input and a play shows from
//! which side, and how far, the input came; a weighted sum of such differences compensates hysteresis (K. Kuhnen,
//! "Modeling, identification and compensation of complex hysteretic nonlinearities", 2003, eq. 2 and 8, the
//! Prandtl–Ishlinskii model). The difference of the input and a lag does the same for creep and relaxation.

use crate::config::{Lag, MemoryConfig, PLAYS, Play};
use crate::numeric::scalar::Scalar;

impl<S: Scalar> Play<S> {
    /// Moves the play's output `y` with the input `x`; gives the weighted difference.
    fn update(&self, y: &mut S, x: S) -> S {
        let ahead = x - *y;
        let ahead = if ahead.is_within(self.radius) {
            ahead
        } else if ahead < S::zero() {
            -self.radius
        } else {
            self.radius
        };
        *y = x - ahead;
        self.weight * ahead
    }
}

impl<S: Scalar> Lag<S> {
    /// Moves the lag's output `y` towards the input `x` over a time `dt`; gives the weighted difference.
    fn update(&self, y: &mut S, x: S, dt: S) -> S {
        let limit = S::one() / self.rate;
        let share = if dt < limit { self.rate * dt } else { S::one() };
        *y += share * (x - *y);
        self.weight * (x - *y)
    }
}

/// Compensation of a segment's hysteresis by three plays: θ + Σ w (θ − play(θ)).
#[derive(Debug, Clone, Copy)]
pub struct PrandtlIshlinskii<S> {
    /// Outputs of the plays; `None` before the first angle, which sets them all.
    outputs: Option<[S; PLAYS]>,
}

impl<S: Scalar> PrandtlIshlinskii<S> {
    /// Before the first angle.
    pub const fn new() -> Self {
        Self { outputs: None }
    }

    /// The compensated angle.
    pub fn compensate(&mut self, plays: &[Play<S>; PLAYS], theta: S) -> S {
        let outputs = self.outputs.get_or_insert([theta; PLAYS]);
        plays.iter().zip(outputs).fold(theta, |sum, (play, output)| sum + play.update(output, theta))
    }
}

/// Compensation of one sensor's creep and hysteresis.
#[derive(Debug, Clone, Copy)]
pub struct Memory<S> {
    state: Option<MemoryState<S>>,
}

#[derive(Debug, Clone, Copy)]
struct MemoryState<S> {
    lags: [S; 2],
    plays: [S; 2],
    read_at_us: u64,
}

impl<S: Scalar> Memory<S> {
    /// Before the first angle.
    pub const fn new() -> Self {
        Self { state: None }
    }

    /// The compensated angle of a reading at `time_us`.
    #[inline(never)]
    pub fn compensate(&mut self, config: &MemoryConfig<S>, theta: S, time_us: u64) -> S {
        let start = MemoryState { lags: [theta; 2], plays: [theta; 2], read_at_us: time_us };
        let state = self.state.get_or_insert(start);
        let dt = S::from_micros(time_us.saturating_sub(state.read_at_us).min(u64::from(u32::MAX)) as u32);
        state.read_at_us = time_us;
        let lags = config.lags.iter().zip(&mut state.lags).map(|(lag, output)| lag.update(output, theta, dt));
        let sum = lags.fold(theta, |sum, difference| sum + difference);
        let plays = config.plays.iter().zip(&mut state.plays).map(|(play, output)| play.update(output, theta));
        plays.fold(sum, |sum, difference| sum + difference)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::{Memory, Play, PrandtlIshlinskii};
    use crate::config::{Lag, MemoryConfig};

    const PLAYS: [Play<f64>; 3] =
        [Play { radius: 0.1, weight: 0.5 }, Play { radius: 0.0, weight: 1.0 }, Play { radius: 1.0, weight: 0.0 }];

    fn compensated(thetas: &[f64]) -> Vec<f64> {
        let mut model = PrandtlIshlinskii::new();
        thetas.iter().map(|theta| model.compensate(&PLAYS, *theta)).collect()
    }

    #[test]
    fn the_first_angle_is_not_changed() {
        assert_eq!(compensated(&[0.7]), [0.7]);
    }

    #[test]
    fn the_same_angle_is_corrected_by_the_side_that_it_is_reached_from() {
        let [.., from_below] = compensated(&[0.0, 0.5])[..] else { panic!() };
        let [.., from_above] = compensated(&[1.0, 0.5])[..] else { panic!() };
        // The play of 0.1 is at its edge: half of it to either side.
        assert!((from_below - 0.55).abs() < 1e-12 && (from_above - 0.45).abs() < 1e-12);
    }

    #[test]
    fn inside_a_play_its_output_stays() {
        let seen = compensated(&[0.0, 0.5, 0.45, 0.5]);
        assert!((seen[3] - seen[1]).abs() < 1e-12 && (seen[2] - 0.475).abs() < 1e-12, "{seen:?}");
    }

    /// One lag of 4 s with weight −1: it replaces the angle by its lag.
    const LAG: MemoryConfig<f64> = MemoryConfig {
        lags: [Lag { rate: 16.0, weight: -1.0 }, Lag { rate: 16.0, weight: 0.0 }],
        plays: [Play { radius: 0.1, weight: 0.0 }; 2],
    };

    #[test]
    fn a_lag_follows_a_step_with_its_time_constant() {
        let mut memory = Memory::new();
        memory.compensate(&LAG, 0.0, 0);
        let after_4_s = (1..=400).map(|k| memory.compensate(&LAG, 1.0, k * 10_000)).last();
        let expected = 1.0 - (-1.0_f64).exp();
        assert!((after_4_s.expect("400 angles") - expected).abs() < 2e-3);
    }

    #[test]
    fn after_a_long_gap_a_lag_has_caught_up() {
        let mut memory = Memory::new();
        memory.compensate(&LAG, 0.0, 0);
        assert!((memory.compensate(&LAG, 1.0, 300_000_000) - 1.0).abs() < 1e-12);
    }
}
