//! Pneumatics and actuators: from a regulator's duty to a segment's free bend angle.

use crate::constants::{
    ACTUATOR_CREEP_S, ACTUATOR_CREEP_SHARE, ACTUATOR_LAG_S, ACTUATOR_PLAY_RAD, FULL_BEND_RAD, FULL_SCALE_PA,
    GAIN_SIGMA, GRID_S, REGULATOR_LAG_S, STIFFENING,
};
use crate::noise::{Noise, Source};

/// First-order lag on the fixed grid, exact for an input that holds between grid points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lag {
    pub(crate) value: f64,
    pub(crate) share: f64,
}

impl Lag {
    /// Starts at `value`; follows with time constant `lag_s` when fed every `period_s`.
    pub(crate) fn new(value: f64, lag_s: f64, period_s: f64) -> Self {
        Self { value, share: -libm::expm1(-period_s / lag_s) }
    }

    /// The value after one more period of `input`.
    pub(crate) fn follow(&mut self, input: f64) -> f64 {
        self.value += self.share * (input - self.value);
        self.value
    }
}

/// Play operator: follows its input only when pushed by one of its edges, `half_width` away.
pub(crate) fn play(value: f64, input: f64, half_width: f64) -> f64 {
    value.clamp(input - half_width, input + half_width)
}

/// A pressure regulator.
#[derive(Clone, Debug)]
pub(crate) struct Regulator {
    pressure: Lag,
}

impl Regulator {
    pub(crate) fn vented() -> Self {
        Self { pressure: Lag::new(0.0, REGULATOR_LAG_S, GRID_S) }
    }

    /// Pressure in Pa after one more grid step at `duty`. No number counts as 0, others are clamped to 0 … 1.
    pub(crate) fn step(&mut self, duty: f64) -> f64 {
        let duty = if duty.is_nan() { 0.0 } else { duty.clamp(0.0, 1.0) };
        self.pressure.follow(FULL_SCALE_PA * duty)
    }
}

/// The pneumatic half of one segment: stiffening, play, prompt response and creep.
#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    gain: f64,
    held: f64,
    prompt: Lag,
    creep: Lag,
}

impl Actuator {
    /// Segment `segment` of the arm, counted from 0, straight.
    pub(crate) fn new(segment: usize) -> Self {
        let gain = Noise::of_arm(Source::Actuator, segment).tolerance((1.0, GAIN_SIGMA));
        Self {
            gain,
            held: 0.0,
            prompt: Lag::new(0.0, ACTUATOR_LAG_S, GRID_S),
            creep: Lag::new(0.0, ACTUATOR_CREEP_S, GRID_S),
        }
    }

    /// Free bend angle in rad after one more grid step at `difference_pa` = right − left.
    pub(crate) fn step(&mut self, difference_pa: f64) -> f64 {
        let drive = difference_pa / FULL_SCALE_PA;
        let target = self.gain * FULL_BEND_RAD * drive * (1.0 + STIFFENING * (1.0 - drive * drive));
        self.held = play(self.held, target, ACTUATOR_PLAY_RAD);
        let prompt = self.prompt.follow(self.held);
        let creep = self.creep.follow(self.held);
        (1.0 - ACTUATOR_CREEP_SHARE) * prompt + ACTUATOR_CREEP_SHARE * creep
    }
}

#[cfg(test)]
mod tests {
    use super::{Actuator, Regulator};
    use crate::constants::{DEGREE_RAD, FULL_BEND_RAD, FULL_SCALE_PA};

    #[test]
    fn regulator_settles_at_its_full_scale() {
        let mut regulator = Regulator::vented();
        let settled = (0..2000).fold(0.0, |_, _| regulator.step(1.0));
        assert!((settled - FULL_SCALE_PA).abs() < 1.0, "{settled} Pa");
    }

    #[test]
    fn no_number_vents_the_regulator() {
        let mut regulator = Regulator::vented();
        assert!(regulator.step(f64::NAN).abs() < f64::EPSILON);
    }

    #[test]
    fn full_pressure_bends_by_the_full_angle() {
        let mut actuator = Actuator::new(0);
        let bend = (0..100_000).fold(0.0, |_, _| actuator.step(FULL_SCALE_PA));
        assert!((bend - FULL_BEND_RAD).abs() < 8.0 * DEGREE_RAD, "{bend} rad");
    }

    #[test]
    fn play_keeps_a_memory_of_direction() {
        let mut actuator = Actuator::new(0);
        let mut settle = |pressure| (0..100_000).fold(0.0, |_, _| actuator.step(pressure));
        let rising = settle(0.5 * FULL_SCALE_PA);
        settle(FULL_SCALE_PA);
        let falling = settle(0.5 * FULL_SCALE_PA);
        assert!(falling - rising > DEGREE_RAD, "{rising} rad, then {falling} rad");
    }
}
