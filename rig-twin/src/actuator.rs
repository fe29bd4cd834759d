//! Pneumatics and actuators: from a regulator's duty to a segment's free bend angle.

use crate::arm::{ActuatorParameters, RegulatorParameters};
use crate::constants::{FULL_BEND_RAD, FULL_SCALE_PA, GRID_S};

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

/// Play operator: the output follows the input only while the input pushes an edge, `radius` away.
pub(crate) fn play(value: f64, input: f64, radius: f64) -> f64 {
    value.clamp(input - radius, input + radius)
}

/// A pressure regulator.
#[derive(Clone, Debug)]
pub(crate) struct Regulator {
    parameters: RegulatorParameters,
    pressure: Lag,
}

impl Regulator {
    pub(crate) fn vented(parameters: RegulatorParameters) -> Self {
        Self { parameters, pressure: Lag::new(0.0, parameters.lag_s, GRID_S) }
    }

    /// Pressure in Pa after one more grid step at `duty`, which is clamped to 0 … 1; NaN counts as 0.
    pub(crate) fn step(&mut self, duty: f64) -> f64 {
        let duty = if duty.is_nan() { 0.0 } else { duty.clamp(0.0, 1.0) };
        let RegulatorParameters { gain, offset_pa, .. } = self.parameters;
        self.pressure.follow((gain * FULL_SCALE_PA * duty + offset_pa).max(0.0))
    }
}

/// The pneumatic half of one segment: stiffening, play, prompt response and creep.
#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    parameters: ActuatorParameters,
    held: f64,
    prompt: Lag,
    creep: Lag,
}

impl Actuator {
    /// Relaxed.
    pub(crate) fn new(parameters: ActuatorParameters) -> Self {
        Self {
            parameters,
            held: 0.0,
            prompt: Lag::new(0.0, parameters.lag_s, GRID_S),
            creep: Lag::new(0.0, parameters.creep_s, GRID_S),
        }
    }

    /// Free bend angle in rad after one more grid step at `difference_pa` = right − left.
    pub(crate) fn step(&mut self, difference_pa: f64) -> f64 {
        let drive = difference_pa / FULL_SCALE_PA;
        let ActuatorParameters { gains: [right, left], stiffening, play_rad, creep_share, .. } = self.parameters;
        let gain = if drive > 0.0 { right } else { left };
        let target = gain * FULL_BEND_RAD * drive * (1.0 + stiffening * (1.0 - drive * drive));
        self.held = play(self.held, target, play_rad);
        let prompt = self.prompt.follow(self.held);
        let creep = self.creep.follow(self.held);
        (1.0 - creep_share) * prompt + creep_share * creep
    }
}

#[cfg(test)]
mod tests {
    use super::{Actuator, Regulator};
    use crate::arm::ArmParameters;
    use crate::constants::{DEGREE_RAD, FULL_BEND_RAD, FULL_SCALE_PA};
    use crate::layout::Layout;

    fn regulator() -> Regulator {
        Regulator::vented(ArmParameters::new(0, &Layout::default()).regulators[0])
    }

    fn actuator() -> Actuator {
        Actuator::new(ArmParameters::new(0, &Layout::default()).actuators[0])
    }

    #[test]
    fn regulator_settles_at_its_full_scale() {
        let mut regulator = regulator();
        let settled = (0..2000).fold(0.0, |_, _| regulator.step(1.0));
        assert!((settled - FULL_SCALE_PA).abs() < 1.0, "{settled} Pa");
    }

    #[test]
    fn no_number_vents_the_regulator() {
        let mut regulator = regulator();
        assert!(regulator.step(f64::NAN).abs() < f64::EPSILON);
    }

    #[test]
    fn full_pressure_bends_by_the_full_angle() {
        let mut actuator = actuator();
        let bend = (0..100_000).fold(0.0, |_, _| actuator.step(FULL_SCALE_PA));
        assert!((bend - FULL_BEND_RAD).abs() < 8.0 * DEGREE_RAD, "{bend} rad");
    }

    #[test]
    fn play_keeps_a_memory_of_direction() {
        let mut actuator = actuator();
        let mut settle = |pressure| (0..100_000).fold(0.0, |_, _| actuator.step(pressure));
        let rising = settle(0.5 * FULL_SCALE_PA);
        settle(FULL_SCALE_PA);
        let falling = settle(0.5 * FULL_SCALE_PA);
        assert!(falling - rising > DEGREE_RAD, "{rising} rad, then {falling} rad");
    }
}
