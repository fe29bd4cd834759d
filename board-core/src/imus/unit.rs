//! One IMU of the arm: when it is asked, and what its answers make of its state.

use super::bus::{Asked, Bus, BusRecovery};
use super::frozen::Frozen;
use crate::bno055::{Answer, Bno055};
use crate::tca9548a::Channel;
use embedded_hal::digital::OutputPin;
use embedded_hal_async::i2c::I2c;
use telemetry::{SEGMENTS, SensorHealth, SensorState};

/// An IMU that refused so often in a row is asked only after a pause.
const REFUSALS: u8 = 3;
/// Ticks from one question to the next in that pause: 250 ms.
const PAUSE_TICKS: u32 = 25;
/// Ticks without a good reading until the state says so: 30 ms.
const BAD_TICKS: u8 = 3;

/// What came of an IMU in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It was not its turn, or the tick ended before.
    Skipped,
    /// The tick ended while it was asked.
    Cut,
    /// It was asked to the end.
    Done(Asked),
}

#[derive(Debug)]
pub(super) struct Unit {
    imu: Bno055,
    outcome: Outcome,
    refusals: u8,
    asked_at: u32,
    bad_ticks: u8,
    /// What the state will be when there are enough bad ticks.
    complaint: SensorState,
    frozen: Frozen,
    health: SensorHealth,
}

impl Unit {
    pub(super) const fn new(address: u8) -> Self {
        Self {
            imu: Bno055::new(address),
            outcome: Outcome::Skipped,
            refusals: 0,
            asked_at: 0,
            bad_ticks: BAD_TICKS,
            complaint: SensorState::Off,
            frozen: Frozen::NEVER_READ,
            health: SensorHealth { state: SensorState::Off, missed: 0 },
        }
    }

    /// Whether the bus is to be given to it in this tick.
    pub(super) fn is_due(&self, tick: u32) -> bool {
        let pauses = self.refusals >= REFUSALS && tick.wrapping_sub(self.asked_at) < PAUSE_TICKS;
        !pauses && !self.imu.is_waiting(tick)
    }

    pub(super) async fn read<I: I2c + BusRecovery, R: OutputPin>(
        &mut self,
        bus: &mut Bus<I, R>,
        channel: Channel,
        tick: u32,
    ) {
        // If this is cut off, the others shall not pay for it again soon.
        let refusals = core::mem::replace(&mut self.refusals, REFUSALS);
        self.outcome = Outcome::Cut;
        self.asked_at = tick;
        let asked = bus.ask(&mut self.imu, channel, tick).await;
        self.outcome = Outcome::Done(asked);
        self.refusals = match asked {
            Asked::Answered(_) => 0,
            Asked::Refused | Asked::Failed => refusals.saturating_add(1),
            Asked::Unreached => refusals,
        };
    }

    /// The quaternion of this tick, whether or not it is to be trusted.
    pub(super) fn seen(&self) -> Option<[i16; 4]> {
        match self.outcome {
            Outcome::Done(Asked::Answered(Answer::Quaternion(quaternion))) => Some(quaternion),
            _ => None,
        }
    }

    /// Ends the tick: the reading, where it is to be trusted. `seen` is what all IMUs read in it.
    pub(super) fn judge(&mut self, seen: &[Option<[i16; 4]>; SEGMENTS]) -> Option<[i16; 4]> {
        let quaternion = self.seen();
        let outcome = core::mem::replace(&mut self.outcome, Outcome::Skipped);
        if let Some(quaternion) = quaternion {
            self.bad_ticks = 0;
            self.complaint = SensorState::Off;
            let is_stuck = self.frozen.watch(quaternion, seen);
            self.health.state = if is_stuck { SensorState::Stuck } else { SensorState::Ok };
        } else {
            self.complain(outcome);
        }
        let trusted = quaternion.filter(|_| self.health.state == SensorState::Ok);
        if trusted.is_none() {
            self.health.missed = self.health.missed.saturating_add(1);
        }
        trusted
    }

    pub(super) fn health(&self) -> SensorHealth {
        self.health
    }

    fn complain(&mut self, outcome: Outcome) {
        self.bad_ticks = self.bad_ticks.saturating_add(1);
        match outcome {
            Outcome::Skipped | Outcome::Done(Asked::Unreached) => {}
            Outcome::Cut => self.complaint = SensorState::Slow,
            Outcome::Done(Asked::Answered(Answer::Garbage)) => self.complaint = SensorState::Garbage,
            Outcome::Done(Asked::Refused | Asked::Failed) => self.complaint = SensorState::Off,
            Outcome::Done(Asked::Answered(Answer::Starting | Answer::Quaternion(_))) => {
                // It lost its heading: that is to be known at once.
                self.complaint = SensorState::Off;
                self.bad_ticks = BAD_TICKS;
            }
        }
        if self.bad_ticks >= BAD_TICKS {
            self.health.state = self.complaint;
        }
    }
}
