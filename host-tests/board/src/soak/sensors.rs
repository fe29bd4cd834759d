//! States of the sensors and conditions of the segments, from the board's last health and events.

use telemetry::{Conditions, Event, Health, MAX_BEND_SENSORS, MAX_SEGMENTS, SensorState};

/// State of each sensor and segment.
pub struct Reported {
    bend: [SensorState; MAX_BEND_SENSORS],
    imu: [SensorState; MAX_SEGMENTS],
    conditions: [Conditions; MAX_SEGMENTS],
}

impl Reported {
    /// Before the first report.
    pub const fn new() -> Self {
        Self {
            bend: [SensorState::NotWired; MAX_BEND_SENSORS],
            imu: [SensorState::NotWired; MAX_SEGMENTS],
            conditions: [Conditions(0); MAX_SEGMENTS],
        }
    }

    /// Takes the states of a health message.
    pub fn health(&mut self, health: &Health) {
        self.bend.iter_mut().zip(&health.bend).for_each(|(state, now)| *state = now.state);
        self.imu.iter_mut().zip(&health.imu).for_each(|(state, now)| *state = now.state);
        self.conditions.iter_mut().zip(&health.conditions).for_each(|(state, now)| *state = *now);
    }

    /// Takes a change.
    pub fn event(&mut self, event: Event) {
        match event {
            Event::Bend(sensor, state) => self.bend[usize::from(sensor)] = state,
            Event::Imu(imu, state) => self.imu[usize::from(imu)] = state,
            Event::Condition(segment, conditions) => self.conditions[usize::from(segment)] = conditions,
            _ => {}
        }
    }

    /// True if every sensor is Ok.
    pub fn are_ok(&self) -> bool {
        let is_ok = |state: &SensorState| matches!(state, SensorState::Ok | SensorState::NotWired);
        self.bend.iter().chain(&self.imu).all(is_ok)
    }

    /// True if a sensor is not Ok, or a segment's estimate is degraded.
    pub fn are_flagged(&self) -> bool {
        !self.are_ok() || self.conditions.iter().any(|conditions| conditions.is_degraded())
    }
}
