//! First-order Gauss–Markov process: an error that is correlated over a time.

use crate::actuator::Lag;
use crate::noise::Noise;

/// White noise through a first-order lag, scaled to a stationary RMS.
#[derive(Clone, Debug)]
pub(crate) struct GaussMarkov {
    rms: f64,
    lag: Lag,
    noise: Noise,
}

impl GaussMarkov {
    /// Starts in the stationary distribution; stepped every `period_s`.
    pub(crate) fn new(rms: f64, time_s: f64, period_s: f64, mut noise: Noise) -> Self {
        Self { rms, lag: Lag::new(rms * noise.gaussian(), time_s, period_s), noise }
    }

    /// The value after one more period.
    pub(crate) fn step(&mut self) -> f64 {
        let gain = libm::sqrt((2.0 - self.lag.share) / self.lag.share);
        self.lag.follow(self.rms * gain * self.noise.gaussian())
    }
}

#[cfg(test)]
mod tests {
    use super::{GaussMarkov, Noise};
    use crate::noise::{Seeds, Source};

    #[test]
    fn process_keeps_its_rms() {
        let noise = Noise::of_session(Seeds { arm: 1, session: 1 }, Source::Imu, 0);
        let mut process = GaussMarkov::new(2.0, 5.0, 0.1, noise);
        let count = 200_000;
        let power = (0..count).map(|_| process.step().powi(2)).sum::<f64>() / f64::from(count);
        assert!((power.sqrt() - 2.0).abs() < 0.15, "{}", power.sqrt());
    }
}
