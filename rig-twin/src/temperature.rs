//! Temperature of the arm and its sensors over a session.

use crate::actuator::Lag;
use crate::flaws::{AMBIENT_SIGMA_K, CYCLE_K, CYCLE_S, WARM_UP_K, WARM_UP_S};
use crate::noise::{Noise, Seeds, Source};
use core::f64::consts::TAU;

/// Temperature above that at which the arm's nominal parameters hold, K.
///
/// The room's temperature of the day, the warming-up of the electronics, and the cycle of the room's
/// heating.
#[derive(Clone, Debug)]
pub(crate) struct Temperature {
    ambient_k: f64,
    warm_up_k: f64,
    warm_up: Lag,
    cycle_k: f64,
    cycle_step_rad: f64,
    cycle_rad: f64,
}

impl Temperature {
    /// The temperature of a session, stepped every `period_s`. The electronics may be warm already.
    pub(crate) fn new(seeds: Seeds, period_s: f64) -> Self {
        let mut noise = Noise::of_session(seeds, Source::Temperature, 0);
        Self {
            ambient_k: noise.tolerance((0.0, AMBIENT_SIGMA_K)),
            warm_up_k: noise.between(WARM_UP_K),
            warm_up: Lag::new(noise.uniform(), noise.between(WARM_UP_S), period_s),
            cycle_k: noise.between(CYCLE_K),
            cycle_step_rad: TAU * period_s / noise.between(CYCLE_S),
            cycle_rad: noise.between((0.0, TAU)),
        }
    }

    /// The value after one more period, K.
    pub(crate) fn step(&mut self) -> f64 {
        self.cycle_rad += self.cycle_step_rad;
        let warm_up_k = self.warm_up_k * self.warm_up.follow(1.0);
        self.ambient_k + warm_up_k + self.cycle_k * libm::sin(self.cycle_rad)
    }
}
