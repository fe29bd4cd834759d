//! Segments, sensors and regulators of a new arm.

use board_table::{ANALOG_PINS, MAX_FULL_SCALE_PA, MAX_REGULATORS, MAX_SEGMENTS};

use super::error::{LENGTHS_MM, NewArmError};

/// Segments, sensors and regulators of a new arm.
#[derive(Debug, Clone, PartialEq)]
pub struct NewArm {
    /// Its name.
    pub name: String,
    /// Length of each segment, from the base, mm.
    pub lengths_mm: Vec<f64>,
    /// Bend sensors of each segment, 0 to 2.
    pub bend_sensors: Vec<u8>,
    /// Number of regulators.
    pub regulators: u8,
    /// Full scale of each regulator, kPa over the atmosphere.
    pub full_scale_kpa: f64,
}

impl NewArm {
    /// Checks that the board has room and pins for the arm.
    pub fn check(&self) -> Result<(), NewArmError> {
        let segments = self.lengths_mm.len();
        if !(1..=MAX_SEGMENTS).contains(&segments) {
            return Err(NewArmError::Segments(segments));
        }
        for (segment, &length_mm) in (1..).zip(&self.lengths_mm) {
            if !LENGTHS_MM.contains(&length_mm) {
                return Err(NewArmError::Length { segment, length_mm });
            }
        }
        if self.bend_sensors.len() != segments {
            return Err(NewArmError::BendSegments { found: self.bend_sensors.len(), expected: segments });
        }
        for (segment, &sensors) in (1..).zip(&self.bend_sensors) {
            if sensors > 2 {
                return Err(NewArmError::SegmentSensors { segment, sensors });
            }
        }
        let sensors = self.bend_sensors.iter().copied().map(usize::from).sum();
        if sensors > usize::from(ANALOG_PINS) {
            return Err(NewArmError::BendSensors(sensors));
        }
        if usize::from(self.regulators) > MAX_REGULATORS {
            return Err(NewArmError::Regulators(self.regulators));
        }
        if !(0.001..=f64::from(MAX_FULL_SCALE_PA) / 1000.0).contains(&self.full_scale_kpa) {
            return Err(NewArmError::FullScale(self.full_scale_kpa));
        }
        Ok(())
    }
}
