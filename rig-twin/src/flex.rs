//! Bend sensors: Spectra Symbol strips with a memory, in dividers that a 12-bit ADC reads.

use crate::actuator::{Lag, play};
use crate::constants::{
    ADC_FULL_SCALE_COUNTS, ADC_NOISE_COUNTS, COMMON_MODE_RAD, COMMON_MODE_S, DIVIDER_OHM, FLAT_OHM, FLAT_SIGMA,
    GAUGE_PER_RAD, GRID_S, MEMORY_PLAY_RAD, MEMORY_SHARE, MEMORY_SIGMA, PRE_BEND_RAD, RIPPLE_PERIOD_RAD, RIPPLE_RAD,
    STORED_BEND_SIGMA_RAD, STRIP_BALANCE, STRIP_CREEP_S, STRIP_CREEP_SHARE, STRIP_LENGTH, STRIP_RELAXATION_S,
    STRIP_RELAXATION_SHARE, STRIP_START,
};
use crate::noise::{Noise, Source};
use crate::shape::Curve;
use core::f64::consts::TAU;

/// What both strips of a segment feel alike, beyond the bend: noise through a lag.
#[derive(Clone, Debug)]
pub(crate) struct CommonMode {
    lag: Lag,
    noise: Noise,
}

impl CommonMode {
    /// That of segment `segment`, counted from 0, in the session of `seed`, stepped every `period_s`.
    pub(crate) fn new(segment: usize, seed: u64, period_s: f64) -> Self {
        let mut noise = Noise::of_session(seed, Source::CommonMode, segment);
        Self { lag: Lag::new(COMMON_MODE_RAD * noise.gaussian(), COMMON_MODE_S, period_s), noise }
    }

    /// Its value after one more period, rad. White noise of this size keeps the lag's output at its RMS.
    pub(crate) fn step(&mut self) -> f64 {
        let gain = libm::sqrt((2.0 - self.lag.share) / self.lag.share);
        self.lag.follow(COMMON_MODE_RAD * gain * self.noise.gaussian())
    }
}

/// One strip and its divider.
#[derive(Clone, Debug)]
pub(crate) struct BendSensor {
    /// 1 for sensor a, −1 for sensor b, on the other side of the arm: its resistance falls where the other's rises.
    side: f64,
    start: f64,
    balance: f64,
    memory: [f64; 3],
    memory_share: [f64; 3],
    creep: Lag,
    creep_share: f64,
    relaxation: Lag,
    relaxation_share: f64,
    pre_bend_rad: f64,
    ripple_rate: f64,
    ripple_phase_rad: f64,
    flat_ohm: f64,
    gauge_per_rad: f64,
    response_rad: f64,
    common_rad: f64,
}

impl BendSensor {
    /// Sensor `index` in the order 1a, 1b, 2a, …; the session's seed gives what it remembers from its storage.
    pub(crate) fn new(index: usize, seed: u64) -> Self {
        let mut arm = Noise::of_arm(Source::BendSensor, index);
        let mut session = Noise::of_session(seed, Source::BendSensor, index);
        let memory_scale = arm.tolerance((1.0, MEMORY_SIGMA));
        let mut sensor = Self {
            side: if index.is_multiple_of(2) { 1.0 } else { -1.0 },
            start: arm.tolerance(STRIP_START),
            balance: arm.tolerance(STRIP_BALANCE),
            memory: MEMORY_PLAY_RAD.map(|half_width| session.between((-half_width, half_width))),
            memory_share: MEMORY_SHARE.map(|share| memory_scale * share),
            creep: Lag::new(STORED_BEND_SIGMA_RAD * session.gaussian(), STRIP_CREEP_S, GRID_S),
            creep_share: arm.tolerance(STRIP_CREEP_SHARE),
            relaxation: Lag::new(0.0, STRIP_RELAXATION_S, GRID_S),
            relaxation_share: arm.tolerance(STRIP_RELAXATION_SHARE),
            pre_bend_rad: arm.tolerance(PRE_BEND_RAD),
            ripple_rate: TAU / arm.between(RIPPLE_PERIOD_RAD),
            ripple_phase_rad: arm.between((0.0, TAU)),
            flat_ohm: FLAT_OHM * arm.tolerance((1.0, FLAT_SIGMA)),
            gauge_per_rad: arm.tolerance(GAUGE_PER_RAD),
            response_rad: 0.0,
            common_rad: 0.0,
        };
        sensor.remember(0.0);
        sensor
    }

    /// One more grid step on `curve`, while both strips of the segment feel `common_rad` beyond the bend.
    pub(crate) fn step(&mut self, curve: &Curve, common_rad: f64) {
        self.remember(self.felt_rad(curve));
        self.common_rad = common_rad;
    }

    /// The bend that the strip feels, rad: the mean curvature under its two halves, times the curve's length.
    fn felt_rad(&self, curve: &Curve) -> f64 {
        let half = STRIP_LENGTH / 2.0;
        let [start, middle, end] = [0.0, half, STRIP_LENGTH].map(|offset| curve.turned_rad(self.start + offset));
        (self.balance * (middle - start) + (1.0 - self.balance) * (end - middle)) / half
    }

    /// Prandtl–Ishlinskii hysteresis (a sum of plays), an overshoot that relaxes, and creep.
    fn remember(&mut self, felt_rad: f64) {
        let mut response = self.creep_share * self.creep.follow(felt_rad);
        response -= self.relaxation_share * self.relaxation.follow(felt_rad);
        let mut prompt_share = 1.0 - self.creep_share + self.relaxation_share;
        for ((memory, share), half_width) in self.memory.iter_mut().zip(self.memory_share).zip(MEMORY_PLAY_RAD) {
            *memory = play(*memory, felt_rad, half_width);
            response += share * *memory;
            prompt_share -= share;
        }
        self.response_rad = response + prompt_share * felt_rad;
    }

    /// A conversion of the divider's voltage, counts.
    pub(crate) fn convert(&self, noise: &mut Noise) -> u16 {
        let bend_rad = self.pre_bend_rad + self.side * self.response_rad + self.common_rad;
        let rippled_rad = bend_rad + RIPPLE_RAD * libm::sin(bend_rad * self.ripple_rate + self.ripple_phase_rad);
        let strip_ohm = self.flat_ohm * (1.0 + self.gauge_per_rad * rippled_rad.max(0.0));
        let counts = ADC_FULL_SCALE_COUNTS * strip_ohm / (strip_ohm + DIVIDER_OHM);
        (counts + ADC_NOISE_COUNTS * noise.gaussian()).round().clamp(0.0, ADC_FULL_SCALE_COUNTS) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::{BendSensor, Curve, Noise, Source};
    use crate::constants::{BEND_SENSORS, DEGREE_RAD};

    /// Mean of 100 conversions.
    fn mean_counts(sensor: &BendSensor, noise: &mut Noise) -> f64 {
        (0..100).map(|_| f64::from(sensor.convert(noise))).sum::<f64>() / 100.0
    }

    #[test]
    fn counts_rise_or_fall_with_the_bend_over_the_whole_range() {
        let mut noise = Noise::of_session(1, Source::Converter, 0);
        for index in 0..BEND_SENSORS {
            let mut sensor = BendSensor::new(index, 1);
            let mut curve = Curve::new(index / 2);
            let mut settled_at = |degrees: i32| {
                curve.free_rad = f64::from(degrees) * DEGREE_RAD;
                (0..20_000).for_each(|_| sensor.step(&curve, 0.0));
                mean_counts(&sensor, &mut noise)
            };
            settled_at(-80);
            let stairs: Vec<f64> = (-23..=23).map(|stair| settled_at(3 * stair)).collect();
            let direction = if index % 2 == 0 { 1.0 } else { -1.0 };
            for (stair, pair) in stairs.windows(2).enumerate() {
                let rise = direction * (pair[1] - pair[0]);
                assert!(rise > 1.0, "sensor {index}, stair {stair}: {rise} counts");
            }
        }
    }
}
