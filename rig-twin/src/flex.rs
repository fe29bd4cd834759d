//! Bend sensors: Spectra Symbol strips with hysteresis and creep, in dividers that a 12-bit ADC reads.

use crate::actuator::{Lag, play};
use crate::arm::{PairParameters, StripParameters};
use crate::constants::{ADC_FULL_SCALE_COUNTS, DIVIDER_OHM, FUSION_S, GRID_S, TOLERANCE_LIMIT_SIGMA};
use crate::gauss_markov::GaussMarkov;
use crate::noise::{Noise, Seeds, Source};
use crate::shape::Curve;

/// Common error of both strips of a segment, as bend of the strip.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PairError {
    /// The same resistance on both sides: the pair's readings err in opposite directions, and the
    /// mean does not.
    pub(crate) opposed_rad: f64,
    /// The same bend on both sides: the mean errs as each strip does.
    pub(crate) shared_rad: f64,
}

/// Source of the common errors of the two strips of a segment.
#[derive(Clone, Debug)]
pub(crate) struct PairErrors {
    opposed: GaussMarkov,
    shared: GaussMarkov,
    offset_rad: f64,
    bend_rad_per_k: f64,
}

impl PairErrors {
    /// Errors of segment `segment`, counted from 0, stepped with the IMUs' fusion.
    pub(crate) fn new(parameters: PairParameters, segment: usize, seeds: Seeds) -> Self {
        let PairParameters { opposed_rms_rad, shared_rms_rad, time_s, offset_rad, bend_rad_per_k } = parameters;
        let opposed = Noise::of_session(seeds, Source::CommonMode, segment);
        let mut shared = Noise::of_session(seeds, Source::SharedError, segment);
        Self {
            offset_rad: shared.tolerance((0.0, offset_rad / TOLERANCE_LIMIT_SIGMA)),
            opposed: GaussMarkov::new(opposed_rms_rad, time_s, FUSION_S, opposed),
            shared: GaussMarkov::new(shared_rms_rad, time_s, FUSION_S, shared),
            bend_rad_per_k,
        }
    }

    /// Their value after one more period, at `temperature_k` above nominal.
    pub(crate) fn step(&mut self, temperature_k: f64) -> PairError {
        PairError {
            opposed_rad: self.opposed.step(),
            shared_rad: self.shared.step() + self.offset_rad + self.bend_rad_per_k * temperature_k,
        }
    }
}

/// One strip and its divider.
#[derive(Clone, Debug)]
pub(crate) struct BendSensor {
    parameters: StripParameters,
    /// 1 for sensor a, −1 for sensor b, on the other side of the arm: its resistance falls where the other's rises.
    side: f64,
    memory: [f64; 3],
    creep: [Lag; 2],
    relaxation: Lag,
    response_rad: f64,
    pair: PairError,
    temperature_k: f64,
}

impl BendSensor {
    /// Sensor `index` in the order 1a, 1b, 2a, …; the session's seed draws its stored creep and hysteresis.
    pub(crate) fn new(parameters: StripParameters, index: usize, seeds: Seeds) -> Self {
        let mut session = Noise::of_session(seeds, Source::BendSensor, index);
        let mut slow = Noise::of_session(seeds, Source::SlowCreep, index);
        let memory = parameters.play_rad.map(|radius| session.between((-radius, radius)));
        let [fast_stored, slow_stored] = parameters.stored_bend_rad;
        let stored = [fast_stored * session.gaussian(), slow_stored * slow.gaussian()];
        let mut sensor = Self {
            parameters,
            side: if index.is_multiple_of(2) { 1.0 } else { -1.0 },
            memory,
            creep: core::array::from_fn(|mode| Lag::new(stored[mode], parameters.creep_s[mode], GRID_S)),
            relaxation: Lag::new(0.0, parameters.relaxation_s, GRID_S),
            response_rad: 0.0,
            pair: PairError::default(),
            temperature_k: 0.0,
        };
        sensor.update_memory(0.0);
        sensor
    }

    /// One more grid step on `curve`.
    pub(crate) fn step(&mut self, curve: &Curve, pair: PairError, temperature_k: f64) {
        self.update_memory(self.sensed_bend_rad(curve));
        self.pair = pair;
        self.temperature_k = temperature_k;
    }

    /// Bend under the strip, rad: the mean curvature under its two halves, times the curve's length.
    fn sensed_bend_rad(&self, curve: &Curve) -> f64 {
        let StripParameters { start, length, balance, .. } = self.parameters;
        let half = length / 2.0;
        let [start, middle, end] = [0.0, half, length].map(|offset| curve.turned_rad(start + offset));
        (balance * (middle - start) + (1.0 - balance) * (end - middle)) / half
    }

    /// Prandtl–Ishlinskii hysteresis (a sum of plays), an overshoot that relaxes, and creep.
    fn update_memory(&mut self, sensed_rad: f64) {
        let StripParameters { creep_share, relaxation_share, memory_share, play_rad, .. } = self.parameters;
        let mut response = creep_share[0] * self.creep[0].follow(sensed_rad);
        response += creep_share[1] * self.creep[1].follow(sensed_rad);
        response -= relaxation_share * self.relaxation.follow(sensed_rad);
        let mut prompt_share = 1.0 - creep_share[0] - creep_share[1] + relaxation_share;
        for ((memory, share), radius) in self.memory.iter_mut().zip(memory_share).zip(play_rad) {
            *memory = play(*memory, sensed_rad, radius);
            response += share * *memory;
            prompt_share -= share;
        }
        self.response_rad = response + prompt_share * sensed_rad;
    }

    /// A conversion of the divider's voltage, counts.
    pub(crate) fn convert(&self, noise: &mut Noise) -> u16 {
        let strip = &self.parameters;
        let turned_rad = self.side * (self.response_rad + self.pair.shared_rad);
        let bend_rad = strip.pre_bend_rad + turned_rad + self.pair.opposed_rad;
        let rippled_rad =
            bend_rad + strip.ripple_rad * libm::sin(bend_rad * strip.ripple_rate + strip.ripple_phase_rad);
        let shown_rad = rippled_rad + strip.cubic_per_rad2 * turned_rad * turned_rad * turned_rad;
        let bent_ohm = strip.flat_ohm * (1.0 + strip.gauge_per_rad * shown_rad.max(0.0));
        let strip_ohm = bent_ohm * (1.0 + strip.ohm_share_per_k * self.temperature_k);
        let counts = ADC_FULL_SCALE_COUNTS * strip_ohm / (strip_ohm + DIVIDER_OHM);
        (counts + strip.noise_counts * noise.gaussian()).round().clamp(0.0, ADC_FULL_SCALE_COUNTS) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::{BendSensor, Curve, Noise, PairError, Source};
    use crate::arm::ArmParameters;
    use crate::constants::{BEND_SENSORS, DEGREE_RAD};
    use crate::layout::Layout;
    use crate::noise::Seeds;

    /// Mean of 100 conversions.
    fn mean_counts(sensor: &BendSensor, noise: &mut Noise) -> f64 {
        (0..100).map(|_| f64::from(sensor.convert(noise))).sum::<f64>() / 100.0
    }

    /// Mean counts along stairs of 3° from −69° to 69°, each held for 10 s.
    fn stairs(arm_seed: u64, index: usize) -> Vec<f64> {
        let arm = ArmParameters::new(arm_seed, &Layout::default());
        let seeds = Seeds { arm: arm_seed, session: 1 };
        let mut noise = Noise::of_session(seeds, Source::Converter, 0);
        let mut sensor = BendSensor::new(arm.strips[index].expect("it has all sensors"), index, seeds);
        let mut curve = Curve::new(arm.curves[index / 2]);
        let mut settled_at = |degrees: i32| {
            curve.free_rad = f64::from(degrees) * DEGREE_RAD;
            (0..5_000).for_each(|_| sensor.step(&curve, PairError::default(), 0.0));
            mean_counts(&sensor, &mut noise)
        };
        settled_at(-80);
        (-23..=23).map(|stair| settled_at(3 * stair)).collect()
    }

    #[test]
    fn counts_rise_or_fall_with_the_bend_over_the_whole_range() {
        for (arm_seed, index) in (0..4).flat_map(|arm| (0..BEND_SENSORS).map(move |index| (arm, index))) {
            let direction = if index % 2 == 0 { 1.0 } else { -1.0 };
            for (stair, pair) in stairs(arm_seed, index).windows(2).enumerate() {
                let rise = direction * (pair[1] - pair[0]);
                assert!(rise > 1.0, "arm {arm_seed}, sensor {index}, stair {stair}: {rise} counts");
            }
        }
    }
    /// Shift of the counts of the strips of segment 1 by a pair error and a temperature, on the straight arm.
    fn shift_counts(pair: PairError, temperature_k: f64) -> [f64; 2] {
        let arm = ArmParameters::new(5, &Layout::default());
        let seeds = Seeds { arm: 5, session: 1 };
        let mut noise = Noise::of_session(seeds, Source::Converter, 0);
        let curve = Curve::new(arm.curves[0]);
        [0, 1].map(|index| {
            let mut sensor = BendSensor::new(arm.strips[index].expect("it has all sensors"), index, seeds);
            sensor.step(&curve, PairError::default(), 0.0);
            let before = mean_counts(&sensor, &mut noise);
            sensor.step(&curve, pair, temperature_k);
            mean_counts(&sensor, &mut noise) - before
        })
    }

    #[test]
    fn shared_error_looks_like_a_bend_and_opposed_error_does_not() {
        let rad = 5.0 * DEGREE_RAD;
        let [a, b] = shift_counts(PairError { shared_rad: rad, opposed_rad: 0.0 }, 0.0);
        assert!(a > 5.0 && b < -5.0, "{a} and {b} counts");
        let [a, b] = shift_counts(PairError { shared_rad: 0.0, opposed_rad: rad }, 0.0);
        assert!(a > 5.0 && b > 5.0, "{a} and {b} counts");
    }

    #[test]
    fn warmth_changes_the_counts() {
        let shift = shift_counts(PairError::default(), 20.0);
        assert!(shift.iter().all(|shift| shift.abs() > 1.0), "{shift:?} counts");
    }
}
