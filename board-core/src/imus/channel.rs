//! One IMU of the arm: the polls that it is due for, and its state from their results.

use super::bus::{Bus, BusRecovery, Poll};
use super::stuck::StuckDetector;
use crate::bno055::{Answer, Bno055};
use crate::gap_counter::GapCounter;
use crate::tca9548a::Channel;
use board_table::ImuAddress;
use embedded_hal::digital::OutputPin;
use embedded_hal_async::i2c::I2c;
use telemetry::{MAX_SEGMENTS, SensorHealth, SensorState};

/// NACKs or bus errors in a row after which an IMU is polled only once per pause.
const NACKS: u8 = 3;
/// Ticks from one poll to the next in that pause: 250 ms.
const PAUSE_TICKS: u32 = 25;
/// Ticks in a row without a valid reading until the state changes: 30 ms.
const BAD_TICKS: u8 = 3;

/// Outcome of one tick of an IMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It was not due, or the tick ended before its poll.
    Skipped,
    /// The tick ended during its poll.
    Cut,
    /// Its poll ended.
    Done(Poll),
}

#[derive(Debug)]
pub(super) struct ImuChannel {
    channel: Channel,
    imu: Bno055,
    outcome: Outcome,
    nack_count: u8,
    polled_at: u32,
    bad_in_a_row: u8,
    /// Next state, after enough bad ticks.
    pending_fault: SensorState,
    /// Gaps while it responds.
    gaps: GapCounter,
    stuck: StuckDetector,
    /// The estimator leaves its readings out.
    is_implausible: bool,
    health: SensorHealth,
}

impl ImuChannel {
    /// The IMU at this place, with a mark of its own; `None` for a channel that the multiplexer does not have.
    pub(super) fn new(place: ImuAddress, mark: u8) -> Option<Self> {
        Some(Self {
            channel: Channel::ALL.get(usize::from(place.channel)).copied()?,
            imu: Bno055::new(place.address, mark),
            outcome: Outcome::Skipped,
            nack_count: 0,
            polled_at: 0,
            bad_in_a_row: BAD_TICKS,
            pending_fault: SensorState::NoResponse,
            gaps: GapCounter::default(),
            stuck: StuckDetector::NEVER_READ,
            is_implausible: false,
            health: SensorHealth { state: SensorState::NoResponse, missed: 0 },
        })
    }

    /// Returns whether it is polled in this tick.
    pub(super) fn is_due(&self, tick: u32) -> bool {
        let pauses = self.nack_count >= NACKS && tick.wrapping_sub(self.polled_at) < PAUSE_TICKS;
        !pauses && !self.imu.is_waiting(tick)
    }

    pub(super) async fn read<I: I2c + BusRecovery, R: OutputPin>(&mut self, bus: &mut Bus<I, R>, tick: u32) {
        // Counts as NACKs while the poll is in progress: if it is cut off, the next poll is after the pause, so that it does
        // not take the others' time again.
        let nack_count = core::mem::replace(&mut self.nack_count, NACKS);
        self.outcome = Outcome::Cut;
        self.polled_at = tick;
        let poll = bus.poll(&mut self.imu, self.channel, tick).await;
        self.outcome = Outcome::Done(poll);
        self.nack_count = match poll {
            Poll::Data(_) => 0,
            Poll::Nack | Poll::BusError => nack_count.saturating_add(1),
            Poll::MuxError => nack_count,
        };
    }

    /// Quaternion of this tick, not validated.
    pub(super) fn quaternion(&self) -> Option<[i16; 4]> {
        match self.outcome {
            Outcome::Done(Poll::Data(Answer::Quaternion(quaternion))) => Some(quaternion),
            _ => None,
        }
    }

    /// Ends the tick: updates the state and returns the reading if it is valid. `quaternions` are those of all IMUs in
    /// this tick; `is_copy`: another IMU gives the same ones.
    pub(super) fn validate(
        &mut self,
        quaternions: &[Option<[i16; 4]>; MAX_SEGMENTS],
        is_copy: bool,
    ) -> Option<[i16; 4]> {
        let quaternion = self.quaternion();
        let outcome = core::mem::replace(&mut self.outcome, Outcome::Skipped);
        let is_intermittent = self.gaps.update(quaternion.is_some());
        if let Some(quaternion) = quaternion {
            self.bad_in_a_row = 0;
            self.pending_fault = SensorState::NoResponse;
            let is_stuck = self.stuck.update(quaternion, quaternions);
            self.health.state = if is_stuck {
                SensorState::Stuck
            } else if is_copy {
                SensorState::Invalid
            } else if is_intermittent {
                SensorState::Intermittent
            } else if self.is_implausible {
                SensorState::Inconsistent
            } else {
                SensorState::Ok
            };
        } else {
            self.record_fault(outcome);
        }
        let valid = quaternion.filter(|_| !matches!(self.health.state, SensorState::Stuck | SensorState::Invalid));
        if valid.is_none() {
            self.health.missed = self.health.missed.saturating_add(1);
        }
        valid
    }

    /// Sets whether the estimator leaves its readings out.
    pub(super) fn set_implausible(&mut self, is_implausible: bool) {
        self.is_implausible = is_implausible;
        self.health.state = self.health.state.judged(is_implausible);
    }

    pub(super) fn health(&self) -> SensorHealth {
        self.health
    }

    fn record_fault(&mut self, outcome: Outcome) {
        self.bad_in_a_row = self.bad_in_a_row.saturating_add(1);
        match outcome {
            Outcome::Skipped | Outcome::Done(Poll::MuxError) => {}
            Outcome::Cut => self.pending_fault = SensorState::Timeout,
            Outcome::Done(Poll::Data(Answer::Invalid)) => self.pending_fault = SensorState::Invalid,
            Outcome::Done(Poll::Nack | Poll::BusError) => self.pending_fault = SensorState::NoResponse,
            Outcome::Done(Poll::Data(Answer::Starting | Answer::Quaternion(_))) => {
                // It lost its heading: the state changes at once.
                self.pending_fault = SensorState::NoResponse;
                self.bad_in_a_row = BAD_TICKS;
            }
        }
        if self.bad_in_a_row >= BAD_TICKS {
            (self.health.state, self.gaps) = (self.pending_fault, GapCounter::default());
        }
    }
}
