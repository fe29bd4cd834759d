//! Faults of the simulated sensors over time.

use super::error::FaultError;
use super::fault::Fault;
use super::imu::{CONFIG_S, ImuEffects, ImuFaults, RESET_S, START_S};
use super::timed::TimedFault;
use crate::constants::ADC_FULL_SCALE_COUNTS;

/// Faults of a rig's sensors.
#[derive(Clone, Debug, Default)]
pub(crate) struct SensorFaults {
    entries: Vec<Entry>,
}

/// A fault and its state.
#[derive(Clone, Debug)]
struct Entry {
    timed: TimedFault,
    is_present: bool,
    /// The counts that a stuck sensor keeps.
    stuck: Option<u16>,
    conversions: u32,
}

impl SensorFaults {
    /// Adds a fault.
    ///
    /// # Errors
    /// [`FaultError::NotInSession`] if it does not act on a sensor's readings.
    pub(crate) fn add(&mut self, timed: TimedFault) -> Result<(), FaultError> {
        if !timed.fault.acts_on_readings() {
            return Err(FaultError::NotInSession(timed.fault.to_string()));
        }
        self.entries.push(Entry { timed, is_present: false, stuck: None, conversions: 0 });
        Ok(())
    }

    /// Ends a fault.
    pub(crate) fn end(&mut self, fault: Fault, time_s: f64) {
        for entry in self.entries.iter_mut().filter(|entry| entry.timed.fault == fault) {
            entry.timed.end_s = entry.timed.end_s.min(time_s);
        }
    }

    /// True if there never was one.
    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Applies what begins and ends by `time_s` to the IMU of a segment.
    pub(crate) fn apply_to_imu(&mut self, segment: usize, imu: &mut ImuFaults, time_s: f64) {
        let mut effects = ImuEffects::default();
        for entry in self.entries.iter_mut().filter(|entry| entry.timed.fault.imu() == Some(segment)) {
            let was_present = std::mem::replace(&mut entry.is_present, entry.timed.is_present(time_s));
            let is_begin = entry.is_present && !was_present;
            match entry.timed.fault {
                Fault::ImuUnplugged(_) if is_begin => imu.lose_power(),
                Fault::ImuUnplugged(_) if was_present && !entry.is_present => imu.start(START_S),
                Fault::ImuReset(_) if is_begin => imu.start(RESET_S),
                Fault::ImuBrownOut(_) if is_begin => imu.start(CONFIG_S),
                Fault::ImuFrozen(_) => effects.is_frozen |= entry.is_present,
                Fault::ImuZeros(_) => effects.is_zero |= entry.is_present,
                Fault::ImuRandom(_) => effects.is_random |= entry.is_present,
                Fault::ImuJump(_, degrees) if entry.is_present => effects.jump_deg += degrees,
                Fault::ImuNorm(_, norm) if entry.is_present => effects.norm *= norm,
                _ => {}
            }
        }
        imu.set(effects);
    }

    /// Counts of a conversion of a bend sensor at `time_s`, in place of `counts`.
    pub(crate) fn convert(&mut self, sensor: usize, counts: u16, time_s: f64) -> u16 {
        let mut converted = f64::from(counts);
        let is_concerned =
            |entry: &&mut Entry| entry.timed.fault.bend_sensor() == Some(sensor) && entry.timed.is_present(time_s);
        for entry in self.entries.iter_mut().filter(is_concerned) {
            entry.conversions += 1;
            converted = match entry.timed.fault {
                Fault::BendOpen(_) => ADC_FULL_SCALE_COUNTS,
                Fault::BendShort(_) => 0.0,
                Fault::BendStuck(_) => f64::from(*entry.stuck.get_or_insert(counts)),
                Fault::BendIntermittent(_) if entry.conversions % 2 == 1 => ADC_FULL_SCALE_COUNTS,
                Fault::BendDrift(_, counts_per_s) => converted + counts_per_s * (time_s - entry.timed.begin_s),
                Fault::BendOffset(_, counts) => converted + counts,
                Fault::BendFactor(_, factor) => converted * factor,
                _ => converted,
            };
        }
        converted.round().clamp(0.0, ADC_FULL_SCALE_COUNTS) as u16
    }
}
