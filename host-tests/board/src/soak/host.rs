//! The host of the soak: it drives the arm while it may, is silent when it is gone, and helps a board that cannot go on.

use rig_twin::{MotionProgram, Scenario};
use telemetry::{Actuation, Command, Event, Message, Refusal, RequestOutcome, TareMode};

use crate::board::Board;

/// What the host wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aim {
    /// The arm swings.
    Swing,
    /// The arm rests, vented.
    Rest,
    /// Nothing is sent.
    Silence,
}

/// A host with its set-points.
pub struct Host {
    program: MotionProgram,
    start_s: f64,
    actuation: Actuation,
    arms_next: bool,
    /// Refused for good: the board needs its power cut.
    pub needs_power_cut: bool,
    /// A tare was executed since [`tare`](Self::tare).
    tare: Option<(u32, Option<RequestOutcome>)>,
}

impl Host {
    /// A host of an arm of this seed.
    pub fn new(seed: u64) -> Self {
        Self {
            program: MotionProgram::new(Scenario::FreeSwing, seed),
            start_s: 0.0,
            actuation: Actuation::Disarmed,
            arms_next: false,
            needs_power_cut: false,
            tare: None,
        }
    }

    /// Takes a message.
    pub fn message(&mut self, message: &Message) {
        match message {
            Message::Event(Event::Actuation(actuation)) => self.actuation = *actuation,
            Message::Health(health) => self.actuation = health.actuation,
            Message::Reply(reply) => {
                let refusal = |refusal| reply.outcome == RequestOutcome::Nack(refusal);
                self.needs_power_cut |= refusal(Refusal::SafeMode) || refusal(Refusal::NoTable);
                if let Some((id, outcome)) = &mut self.tare
                    && *id == reply.id
                {
                    *outcome = Some(reply.outcome);
                }
            }
            _ => {}
        }
    }

    /// The board has restarted.
    pub const fn restart(&mut self) {
        (self.actuation, self.needs_power_cut) = (Actuation::Disarmed, false);
    }

    /// Sends what the aim needs, every 50 ms. Returns true if it has asked for pressures to move.
    pub fn send(&mut self, board: &mut Board, aim: Aim) -> bool {
        match (aim, self.actuation) {
            (Aim::Silence, _) => false,
            (Aim::Rest, Actuation::Disarmed) => {
                // The session stays.
                board.send(Command::Ping);
                false
            }
            (Aim::Rest, _) => {
                board.send(Command::Disarm);
                false
            }
            (Aim::Swing, Actuation::Disarmed) => {
                board.send(if self.arms_next { Command::Arm } else { Command::Ping });
                self.arms_next = !self.arms_next;
                self.start_s = board.machine.seconds();
                // The second of the two.
                !self.arms_next
            }
            (Aim::Swing, _) => {
                board.set_pressures(&self.program.duties(board.machine.seconds() - self.start_s));
                false
            }
        }
    }

    /// Sends a tare.
    pub fn tare(&mut self, board: &mut Board) {
        self.tare = Some((board.send(Command::Tare(TareMode::IfStill)), None));
    }
}
