//! Random numbers: one ChaCha stream for each source, so that readings are independent of each other.

use crate::constants::{REFERENCE_ARM_SEED, TOLERANCE_LIMIT_SIGMA};
use core::f64::consts::TAU;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Seeds of a session: the arm's and its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seeds {
    pub(crate) arm: u64,
    pub(crate) session: u64,
}

/// Source of random numbers. Each source, and each of its devices, has a stream of its own.
#[derive(Clone, Copy)]
pub(crate) enum Source {
    Actuator,
    Curve,
    BendSensor,
    Converter,
    Imu,
    Motion,
    Contact,
    CommonMode,
    Camera,
    Regulator,
    Temperature,
    SharedError,
    SlowCreep,
    TurnOn,
    Instability,
    HeadingWalk,
    Schedule,
    Fault,
}

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    stream: ChaCha8Rng,
    spare: Option<f64>,
}

impl Noise {
    /// Tolerances of an arm: the same in every session.
    pub(crate) fn of_arm(arm_seed: u64, source: Source, device: usize) -> Self {
        let (seed, domain) = if arm_seed == 0 { (REFERENCE_ARM_SEED, 1) } else { (arm_seed, 2) };
        Self::new(key(seed, domain), source, device)
    }

    /// Properties of a session, different for each arm.
    pub(crate) fn of_session(seeds: Seeds, source: Source, device: usize) -> Self {
        let mut key = key(seeds.session, 0);
        key[16..24].copy_from_slice(&seeds.arm.to_le_bytes());
        Self::new(key, source, device)
    }

    fn new(key: [u8; 32], source: Source, device: usize) -> Self {
        let mut stream = ChaCha8Rng::from_seed(key);
        stream.set_stream(((source as u64) << 32) | device as u64);
        Self { stream, spare: None }
    }

    /// Uniform in [0, 1), of 53 bits.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.stream.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two bounds.
    pub(crate) fn between(&mut self, (low, high): (f64, f64)) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// One of 0 … `count` − 1.
    pub(crate) fn pick(&mut self, count: usize) -> usize {
        (self.uniform() * count as f64) as usize
    }

    /// −1 or 1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.uniform() < 0.5 { -1.0 } else { 1.0 }
    }

    /// Standard normal, by Box and Muller.
    pub(crate) fn gaussian(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - self.uniform()));
        let (sin, cos) = libm::sincos(TAU * self.uniform());
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// A tolerance: normal around a mean, its tails cut off.
    pub(crate) fn tolerance(&mut self, (mean, sigma): (f64, f64)) -> f64 {
        mean + sigma * self.gaussian().clamp(-TOLERANCE_LIMIT_SIGMA, TOLERANCE_LIMIT_SIGMA)
    }
}

fn key(seed: u64, domain: u8) -> [u8; 32] {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8] = domain;
    key
}

#[cfg(test)]
mod tests {
    use super::{Noise, Seeds, Source};

    const SEEDS: Seeds = Seeds { arm: 0, session: 1 };

    #[test]
    fn gaussian_has_mean_zero_and_variance_one() {
        let mut noise = Noise::of_session(SEEDS, Source::Converter, 0);
        let draws: Vec<f64> = (0..20_000).map(|_| noise.gaussian()).collect();
        let mean = draws.iter().sum::<f64>() / draws.len() as f64;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / draws.len() as f64;
        assert!(mean.abs() < 0.03, "mean {mean}");
        assert!((variance - 1.0).abs() < 0.05, "variance {variance}");
    }

    #[test]
    fn streams_of_two_devices_differ() {
        let mut first = Noise::of_session(SEEDS, Source::Imu, 0);
        let mut second = Noise::of_session(SEEDS, Source::Imu, 1);
        assert!(first.uniform().to_bits() != second.uniform().to_bits());
    }
    #[test]
    fn sessions_of_one_seed_on_two_arms_share_no_numbers() {
        let [mut first, mut second] = [1, 2].map(|arm| Noise::of_session(Seeds { arm, session: 1 }, Source::Imu, 0));
        assert!(first.uniform().to_bits() != second.uniform().to_bits());
    }
}
