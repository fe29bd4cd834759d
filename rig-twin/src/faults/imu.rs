//! Effect of faults on an IMU's output.

use crate::constants::{DEGREE_RAD, FUSION_S, QUATERNION_UNIT_STEPS};
use crate::noise::Noise;

/// Time without output after a power-on reset (BNO055 datasheet, table 0-2: 650 ms), its mode set at once (table 3-6: 7 ms;
/// the first output after 40 ms is assumed).
pub(super) const RESET_S: f64 = 0.70;
/// Time without output after power (table 0-2: 400 ms), its mode set at once.
pub(super) const START_S: f64 = 0.45;
/// Time without output in CONFIG mode, its mode set at once.
pub(super) const CONFIG_S: f64 = 0.05;

/// Faults that are present on an IMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ImuEffects {
    pub jump_deg: f64,
    pub norm: f64,
    pub is_frozen: bool,
    pub is_zero: bool,
    pub is_random: bool,
}

impl Default for ImuEffects {
    fn default() -> Self {
        Self { jump_deg: 0.0, norm: 1.0, is_frozen: false, is_zero: false, is_random: false }
    }
}

/// Supply of an IMU and the faults on it.
#[derive(Clone, Debug)]
pub(crate) struct ImuFaults {
    effects: ImuEffects,
    is_powered: bool,
    /// Fusion periods until the first output after a start.
    silent_periods: u32,
    random: Noise,
}

impl ImuFaults {
    /// None; `random` draws orientations.
    pub(crate) fn new(random: Noise) -> Self {
        Self { effects: ImuEffects::default(), is_powered: true, silent_periods: 0, random }
    }

    /// Sets the faults that are present.
    pub(super) fn set(&mut self, effects: ImuEffects) {
        self.effects = effects;
    }

    /// The supply fails.
    pub(super) fn lose_power(&mut self) {
        self.is_powered = false;
    }

    /// It starts, and has its first output after this time.
    pub(super) fn start(&mut self, silent_s: f64) {
        self.is_powered = true;
        // The period that is under way counts for nothing.
        self.silent_periods = 1 + (silent_s / FUSION_S).round() as u32;
    }

    /// True if it has output.
    pub(crate) fn has_output(&self) -> bool {
        self.is_powered && self.silent_periods == 0
    }

    /// One more period of the fusion; true if the heading begins at zero in it, as IMUPLUS has no reference to north (BNO055
    /// datasheet 3.3.3.1).
    pub(crate) fn step(&mut self) -> bool {
        let was_silent = self.silent_periods > 0;
        self.silent_periods = self.silent_periods.saturating_sub(1);
        was_silent && self.silent_periods == 0
    }

    /// Angle that is added to the heading, rad.
    pub(crate) fn jump_rad(&self) -> f64 {
        self.effects.jump_deg * DEGREE_RAD
    }

    /// The output in place of `quaternion`; `last` was the one before.
    pub(crate) fn output(&mut self, quaternion: [i16; 4], last: [i16; 4]) -> [i16; 4] {
        let ImuEffects { norm, is_frozen, is_zero, is_random, .. } = self.effects;
        if is_frozen {
            return last;
        }
        if is_zero {
            return [0; 4];
        }
        let quaternion = if is_random { self.draw() } else { quaternion };
        // A cast saturates; at a norm of 1 it changes nothing.
        quaternion.map(|part| (f64::from(part) * norm).round() as i16)
    }

    /// Any orientation.
    fn draw(&mut self) -> [i16; 4] {
        let parts: [f64; 4] = core::array::from_fn(|_| self.random.gaussian());
        let norm = libm::sqrt(parts.iter().map(|part| part * part).sum()).max(f64::MIN_POSITIVE);
        parts.map(|part| (part / norm * QUATERNION_UNIT_STEPS).round() as i16)
    }
}
