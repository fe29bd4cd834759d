//! The host's side of requests: one after the other, each under its own id and repeated until it is answered.
//!
//! A host begins with a Ping: nothing else is sent before one is acknowledged. No request outlives the run of the board
//! that it was meant for: one that arms the pressures must not arrive after a restart.

use std::collections::VecDeque;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use telemetry::{Command, Encoder, MAX_FRAME, Outcome, Refusal, Reply, Request};

/// Time without an answer after which a request is sent again.
const AGAIN: Duration = Duration::from_millis(100);

/// How often a request is sent before it is given up.
const TRIES: u32 = 20;

/// Why a request was not done, as far as the host knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// The board has refused it.
    #[error("the board refuses: {0}")]
    Refused(#[from] Refusal),
    /// It gave no answer for two seconds.
    #[error("the board does not answer")]
    NoAnswer,
    /// It restarted, or its line was lost, before it answered.
    #[error("the board restarted or its line was lost before it answered")]
    Interrupted,
}

/// Where an answer goes.
pub type Answer = Sender<Result<(), RequestError>>;

/// The requests that wait, and the one that is under way.
#[derive(Debug, Default)]
pub struct Requests {
    encoder: Encoder,
    last_id: u32,
    greeted: bool,
    current: Option<Current>,
    waiting: VecDeque<(Command, Answer)>,
}

#[derive(Debug)]
struct Current {
    request: Request,
    /// `None` for the greeting, which is repeated for ever.
    answer: Option<Answer>,
    sent: u32,
    due: Instant,
}

impl Requests {
    /// Takes a request in.
    pub fn push(&mut self, command: Command, answer: Answer) {
        self.waiting.push_back((command, answer));
    }

    /// Whether the board has acknowledged a Ping since it started.
    pub fn greeted(&self) -> bool {
        self.greeted
    }

    /// The bytes to send now, if any: a zero, which ends what is left of a damaged frame, and a frame.
    pub fn due(&mut self, now: Instant) -> Option<Vec<u8>> {
        if self.current.as_ref().is_some_and(|current| current.sent >= TRIES && current.due <= now) {
            self.finish(Err(RequestError::NoAnswer));
        }
        if self.current.is_none() {
            self.begin(now)?;
        }
        let current = self.current.as_mut().filter(|current| current.due <= now)?;
        current.sent = if current.answer.is_some() { current.sent + 1 } else { 1 };
        current.due = now + AGAIN;
        let mut buffer = [0; MAX_FRAME];
        let frame = self.encoder.encode(&current.request, &mut buffer).ok()?;
        Some([&[0], frame].concat())
    }

    /// Makes the next request the one under way.
    fn begin(&mut self, now: Instant) -> Option<()> {
        let (command, answer) = if self.greeted {
            let (command, answer) = self.waiting.pop_front()?;
            (command, Some(answer))
        } else {
            (Command::Ping, None)
        };
        self.last_id = self.last_id.wrapping_add(1);
        let request = Request { id: self.last_id, command };
        self.current = Some(Current { request, answer, sent: 0, due: now });
        Some(())
    }

    /// Takes the board's answer.
    pub fn replied(&mut self, reply: Reply) {
        let Some(current) = self.current.as_ref().filter(|current| current.request.id == reply.id) else { return };
        match reply.outcome {
            Outcome::Ack => {
                self.greeted = true;
                self.finish(Ok(()));
            }
            // It was not looked at: it is sent again.
            Outcome::Nack(Refusal::Busy) => {}
            // A host before has used higher ids; a Ping starts them anew after a while.
            Outcome::Nack(_) if current.answer.is_none() => {}
            Outcome::Nack(refusal) => self.finish(Err(refusal.into())),
        }
    }

    /// The board has restarted, or its line is another: all begins anew, and what was asked is not asked again.
    pub fn interrupt(&mut self) {
        self.finish(Err(RequestError::Interrupted));
        for (_, answer) in self.waiting.drain(..) {
            // Who asked may have left.
            let _ = answer.send(Err(RequestError::Interrupted));
        }
        self.greeted = false;
    }

    fn finish(&mut self, outcome: Result<(), RequestError>) {
        if let Some(answer) = self.current.take().and_then(|current| current.answer) {
            // Who asked may have left.
            let _ = answer.send(outcome);
        }
    }
}
