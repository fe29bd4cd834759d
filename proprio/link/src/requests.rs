//! The host's side of requests: one after the other, each under its own id and repeated until it is answered.
//!
//! A host begins with a Ping: no other request is sent before one is acknowledged. No request outlives the run of the board
//! that it was made for: one that arms the pressures must not arrive after a restart.

use std::collections::VecDeque;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use telemetry::{Command, Encoder, MAX_FRAME, Refusal, Reply, Request, RequestOutcome};

/// Time without an answer after which a request is sent again.
const AGAIN: Duration = Duration::from_millis(100);

/// Number of times that a request is sent before it fails.
const TRIES: u32 = 20;

/// A request that was not acknowledged.
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

/// Channel for the answer to a request.
pub type Answer = Sender<Result<(), RequestError>>;

/// The requests that wait, and the one that is under way.
#[derive(Debug, Default)]
pub struct Requests {
    encoder: Encoder,
    last_id: u32,
    is_connected: bool,
    current: Option<Current>,
    waiting: VecDeque<(Command, Answer)>,
}

#[derive(Debug)]
struct Current {
    request: Request,
    /// `None` for the Ping of the handshake, which is repeated without limit.
    answer: Option<Answer>,
    sent: u32,
    due: Instant,
}

impl Requests {
    /// Adds a request to the queue.
    pub fn push(&mut self, command: Command, answer: Answer) {
        self.waiting.push_back((command, answer));
    }

    /// True once the board has acknowledged a Ping since its start.
    pub fn is_connected(&self) -> bool {
        self.is_connected
    }

    /// The bytes to send now, if any: a zero, which ends the rest of a damaged frame, and a frame.
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
        let (command, answer) = if self.is_connected {
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

    /// Handles a reply of the board.
    pub fn replied(&mut self, reply: Reply) {
        let Some(current) = self.current.as_ref().filter(|current| current.request.id == reply.id) else { return };
        match reply.outcome {
            RequestOutcome::Ack => {
                self.is_connected = true;
                self.finish(Ok(()));
            }
            // The board has not processed it: it is sent again.
            RequestOutcome::Nack(Refusal::Busy) => {}
            // An earlier host has used higher ids. The board accepts a Ping with a lower one after its session timeout.
            RequestOutcome::Nack(_) if current.answer.is_none() => {}
            RequestOutcome::Nack(refusal) => self.finish(Err(refusal.into())),
        }
    }

    /// Ends all requests after a restart of the board or the loss of its line; none of them is sent again.
    pub fn interrupt(&mut self) {
        self.finish(Err(RequestError::Interrupted));
        for (_, answer) in self.waiting.drain(..) {
            // The requesting thread may have stopped waiting.
            let _ = answer.send(Err(RequestError::Interrupted));
        }
        self.is_connected = false;
    }

    fn finish(&mut self, outcome: Result<(), RequestError>) {
        if let Some(answer) = self.current.take().and_then(|current| current.answer) {
            // The requesting thread may have stopped waiting.
            let _ = answer.send(outcome);
        }
    }
}
