//! Memory of a bend sensor: play operators (hysteresis) and first-order lags (creep).
//!
//! The output of a play operator follows its input only while the input pushes one of the play's two edges. The
//! difference of input and output depends on the direction and the size of past motion; a weighted sum of such
//! differences compensates hysteresis (K. Kuhnen, "Modeling, identification and compensation of complex hysteretic
//! nonlinearities", 2003, eq. 2 and 8, the Prandtl–Ishlinskii model). The difference of the input and a lag does the
//! same for creep and relaxation.

use crate::config::{Lag, MemoryConfig, PLAYS, Play};
use crate::numeric::fused::FusedOps;
use crate::numeric::scalar::Scalar;

impl<S: Scalar> Play<S> {
    /// Updates the play's output `y` with the input `x`; returns the difference of both.
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
        ahead
    }
}

impl<S: Scalar> Lag<S> {
    /// Updates the lag's output `y` with the input `x` over a time `dt`.
    fn update(&self, y: &mut S, x: S, dt: S) {
        let share = if dt < self.time { self.rate * dt } else { S::one() };
        *y += share * (x - *y);
    }
}

/// Compensation of a segment's hysteresis by three plays: θ + Σ w (θ − play(θ)).
#[derive(Debug, Clone, Copy)]
pub struct PrandtlIshlinskii<S> {
    /// Outputs of the plays; `None` before the first angle, which initialises them.
    outputs: Option<[S; PLAYS]>,
}

impl<S: FusedOps> PrandtlIshlinskii<S> {
    /// Before the first angle.
    pub const fn new() -> Self {
        Self { outputs: None }
    }

    /// The compensated angle.
    pub fn compensate(&mut self, plays: &[Play<S>; PLAYS], theta: S) -> S {
        let outputs = self.outputs.get_or_insert([theta; PLAYS]);
        let mut differences = [S::zero(); PLAYS];
        for ((difference, play), output) in differences.iter_mut().zip(plays).zip(outputs) {
            *difference = play.update(output, theta);
        }
        theta + S::dot(plays.map(|play| play.weight), differences)
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
    followed_at_us: u64,
}

impl<S: FusedOps> Memory<S> {
    /// Before the first angle.
    pub const fn new() -> Self {
        Self { state: None }
    }

    /// Correction to add to the angle of a reading at `time_us`, rad. The lags are updated if `followed`; as they are
    /// slow, an update at some of the readings suffices.
    #[inline]
    pub fn correction(&mut self, config: &MemoryConfig<S>, theta: S, time_us: u64, followed: bool) -> S {
        let Some(state) = &mut self.state else {
            self.state = Some(MemoryState { lags: [theta; 2], plays: [theta; 2], followed_at_us: time_us });
            return S::zero();
        };
        if followed {
            let dt = S::from_micros(time_us.saturating_sub(state.followed_at_us).min(u64::from(u32::MAX)) as u32);
            state.followed_at_us = time_us;
            for (lag, output) in config.lags.iter().zip(&mut state.lags) {
                lag.update(output, theta, dt);
            }
        }
        let mut differences = [S::zero(); 2];
        for (difference, output) in differences.iter_mut().zip(&state.lags) {
            *difference = theta - *output;
        }
        let of_lags = S::dot(config.lags.map(|lag| lag.weight), differences);
        let plays = config.plays.iter().zip(&mut state.plays);
        for (difference, (play, output)) in differences.iter_mut().zip(plays) {
            *difference = play.update(output, theta);
        }
        of_lags + S::dot(config.plays.map(|play| play.weight), differences)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::{Memory, Play, PrandtlIshlinskii};
    use crate::config::{Lag, MemoryConfig};
    use crate::numeric::q::Q;

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

    /// One lag of 4 s with weight −1: the result is the output of the lag.
    const LAG: MemoryConfig<f64> = MemoryConfig {
        lags: [Lag { time: 1.0 / 16.0, rate: 16.0, weight: -1.0 }, Lag { time: 1.0 / 16.0, rate: 16.0, weight: 0.0 }],
        plays: [Play { radius: 0.1, weight: 0.0 }; 2],
    };

    fn compensated_by(memory: &mut Memory<f64>, config: &MemoryConfig<f64>, theta: f64, time_us: u64) -> f64 {
        theta + memory.correction(config, theta, time_us, true)
    }

    #[test]
    fn a_lag_follows_a_step_with_its_time_constant() {
        let mut memory = Memory::new();
        compensated_by(&mut memory, &LAG, 0.0, 0);
        let after_4_s = (1..=400).map(|k| compensated_by(&mut memory, &LAG, 1.0, k * 10_000)).last();
        let expected = 1.0 - (-1.0_f64).exp();
        assert!((after_4_s.expect("400 angles") - expected).abs() < 2e-3);
    }

    /// A play of ±0.1 rad and weight 0.5; lags of weight zero.
    const PLAY: MemoryConfig<f64> = MemoryConfig {
        lags: [Lag { time: 1.0 / 16.0, rate: 16.0, weight: 0.0 }; 2],
        plays: [Play { radius: 0.1, weight: 0.5 }, Play { radius: 0.1, weight: 0.0 }],
    };

    #[test]
    fn a_sensor_is_corrected_by_the_side_that_it_comes_from() {
        let at_half = |from: f64| {
            let mut memory = Memory::new();
            compensated_by(&mut memory, &PLAY, from, 0);
            compensated_by(&mut memory, &PLAY, 0.5, 10_000)
        };
        assert!((at_half(0.0) - 0.55).abs() < 1e-12 && (at_half(1.0) - 0.45).abs() < 1e-12);
    }

    #[test]
    fn a_lag_takes_the_same_time_at_any_rate() {
        let after_2_s = |step_us: u64| {
            let mut memory = Memory::new();
            compensated_by(&mut memory, &LAG, 0.0, 0);
            (1..=2_000_000 / step_us)
                .map(|k| compensated_by(&mut memory, &LAG, 1.0, k * step_us))
                .last()
                .expect("some angles")
        };
        assert!((after_2_s(10_000) - after_2_s(100_000)).abs() < 0.01);
    }

    #[test]
    fn a_lag_that_moves_at_every_seventh_reading_is_nearly_the_same() {
        let (mut each, mut seventh) = (Memory::new(), Memory::new());
        for k in 0..10_000_u32 {
            let (theta, time_us) = ((f64::from(k) / 150.0).sin(), u64::from(k) * 10_000);
            let expected = each.correction(&LAG, theta, time_us, true);
            let found = seventh.correction(&LAG, theta, time_us, k % 7 == 0);
            // The lag moves by 0.23 rad/s at most, and by 0.014 rad in the 60 ms between.
            assert!((found - expected).abs() < 0.016, "{found} instead of {expected} at {k}");
        }
    }

    #[test]
    fn in_fixed_point_a_memory_is_that_of_floats() {
        let config = MemoryConfig {
            lags: [Lag { time: 1.0 / 16.0, rate: 16.0, weight: 0.3 }, Lag { time: 0.5, rate: 2.0, weight: -0.2 }],
            plays: [Play { radius: 0.1, weight: 0.5 }, Play { radius: 0.3, weight: 0.2 }],
        };
        let lag = |lag: Lag<f64>| Lag {
            time: Q::from_f64(lag.time),
            rate: Q::from_f64(lag.rate),
            weight: Q::from_f64(lag.weight),
        };
        let play = |play: Play<f64>| Play { radius: Q::from_f64(play.radius), weight: Q::from_f64(play.weight) };
        let fixed = MemoryConfig { lags: config.lags.map(lag), plays: config.plays.map(play) };
        let (mut float_memory, mut fixed_memory) = (Memory::new(), Memory::new());
        for k in 0..100_000_u32 {
            let theta = (f64::from(k) / 150.0).sin();
            let float = theta + float_memory.correction(&config, theta, u64::from(k) * 10_000, true);
            let fixed =
                theta + fixed_memory.correction(&fixed, Q::from_f64(theta), u64::from(k) * 10_000, true).to_f64();
            // A share of a lag is rounded to half a step of 2⁻²⁶ in 0.0003, 2e-5 of it.
            assert!((fixed - float).abs() < 1e-4, "{fixed} instead of {float} at {k}");
        }
    }

    #[test]
    fn after_a_long_gap_a_lag_has_caught_up() {
        let mut memory = Memory::new();
        compensated_by(&mut memory, &LAG, 0.0, 0);
        assert!((compensated_by(&mut memory, &LAG, 1.0, 300_000_000) - 1.0).abs() < 1e-12);
    }
}
