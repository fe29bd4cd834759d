//! Admission of the host's requests: idempotent execution and a rate limit.
//!
//! Bytes from the host may be lost or arrive twice, and a host repeats a request that got no reply. These rules make
//! requests idempotent, with their number as the key: a repeated request is executed once and an old one never.
//!
//! - **Numbers go up.** A request whose number is higher than that of the last executed one is executed. The first one
//!   after boot may have any number.
//! - **A repetition gets the same reply.** The last executed request, received again unchanged, gets its first reply
//!   without being executed. A refusal by the command itself (such as not armed) counts as execution: another attempt
//!   takes a new number.
//! - **An older number is late**: [`Refusal::Late`]. So is another request under the last one's number.
//! - **A `Ping` begins a new session** with its own number if no request was executed for [`SESSION_TIMEOUT_TICKS`].
//!   That is how a new host begins on a board that was not restarted: it repeats a `Ping` until one is acknowledged. The
//!   pressures are vented by then, so that no earlier request can move them.
//! - **A token bucket limits the rate**: [`BUCKET_SIZE`] requests at once, and [`REFILL_PER_TICK`] more each tick. One
//!   more request in a tick is refused as [`Refusal::Busy`], which does not count as execution; the rest get no reply,
//!   so that replies to a flood do not fill the line. A `Disarm` is executed even then.
//!
//! The cost of a request is the same few comparisons in every case.

use telemetry::{Command, Refusal, Reply, Request, RequestOutcome};

/// Ticks of 10 ms without an executed request after which a `Ping` begins a new session.
pub const SESSION_TIMEOUT_TICKS: u32 = 150;

/// Capacity of the token bucket: most requests that are admitted in one tick, after a pause.
pub const BUCKET_SIZE: u8 = 8;

/// Tokens added to the bucket each tick: requests that are admitted per tick in the long run.
pub const REFILL_PER_TICK: u8 = 2;

/// Server of the host's requests.
///
/// ```
/// use board_core::{CommandServer, Execution};
/// use telemetry::{Command, RequestOutcome, Reply, Request, TareMode};
///
/// let mut server = CommandServer::new();
/// let mut tares = 0;
/// let request = Request { id: 7, command: Command::Tare(TareMode::Force) };
/// for tick in 0..2 {
///     // The first reply was lost, and the host repeats the request.
///     let reply = server.answer(&request, tick, |_| {
///         tares += 1;
///         Ok(Execution::Done)
///     });
///     assert_eq!(reply, Some(Reply { id: 7, outcome: RequestOutcome::Ack }));
/// }
/// assert_eq!(tares, 1);
/// ```
#[derive(Debug)]
pub struct CommandServer {
    last: Option<LastRequest>,
    bucket: TokenBucket,
}

/// The last executed request and its outcome.
#[derive(Debug)]
struct LastRequest {
    request: Request,
    /// `None`: pending.
    outcome: Option<RequestOutcome>,
    tick: u32,
}

/// Progress of a command that was not refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Execution {
    /// It was executed.
    Done,
    /// Another task executes it; its reply follows.
    Pending,
}

impl CommandServer {
    /// A server that has received no request.
    pub const fn new() -> Self {
        Self { last: None, bucket: TokenBucket { tick: 0, tokens: BUCKET_SIZE, may_refuse: true } }
    }

    /// Handles a request that was received in this tick: calls `execute` if it is admitted and new, and returns the
    /// reply to send, if any. A request whose execution takes longer has no reply until it is
    /// [completed](Self::complete).
    pub fn answer(
        &mut self,
        request: &Request,
        tick: u32,
        execute: impl FnOnce(&Command) -> Result<Execution, Refusal>,
    ) -> Option<Reply> {
        let admission = self.bucket.take(tick);
        let outcome = if admission == Admission::Admitted || request.command == Command::Disarm {
            self.outcome(request, tick, execute)
        } else {
            Some(RequestOutcome::Nack(Refusal::Busy))
        };
        outcome.filter(|_| admission != Admission::Dropped).map(|outcome| Reply { id: request.id, outcome })
    }

    /// Stores the outcome of a request whose execution was pending, for its repetitions.
    pub fn complete(&mut self, reply: Reply) {
        if let Some(last) = self.last.as_mut().filter(|last| last.request.id == reply.id) {
            last.outcome = Some(reply.outcome);
        }
    }

    fn outcome(
        &mut self,
        request: &Request,
        tick: u32,
        execute: impl FnOnce(&Command) -> Result<Execution, Refusal>,
    ) -> Option<RequestOutcome> {
        if let Some(last) = &self.last {
            let new_session = request.command == Command::Ping && tick.wrapping_sub(last.tick) >= SESSION_TIMEOUT_TICKS;
            if !new_session && *request == last.request {
                return last.outcome;
            }
            if !new_session && request.id <= last.request.id {
                return Some(RequestOutcome::Nack(Refusal::Late));
            }
        }
        let outcome = match execute(&request.command) {
            Ok(Execution::Done) => Some(RequestOutcome::Ack),
            Ok(Execution::Pending) => None,
            Err(refusal) => Some(RequestOutcome::Nack(refusal)),
        };
        self.last = Some(LastRequest { request: request.clone(), outcome, tick });
        outcome
    }
}

impl Default for CommandServer {
    fn default() -> Self {
        Self::new()
    }
}

/// Token bucket: one token per request.
#[derive(Debug)]
struct TokenBucket {
    tick: u32,
    tokens: u8,
    /// No request was refused as busy in this tick yet.
    may_refuse: bool,
}

/// Admission of one request.
#[derive(Debug, PartialEq, Eq)]
enum Admission {
    /// The bucket had a token.
    Admitted,
    /// The bucket is empty: reply that the board is busy.
    Refused,
    /// The bucket is empty, and a request of this tick was refused already: no reply.
    Dropped,
}

impl TokenBucket {
    fn take(&mut self, tick: u32) -> Admission {
        let ticks = tick.wrapping_sub(self.tick);
        if ticks > 0 {
            let refill = ticks.saturating_mul(u32::from(REFILL_PER_TICK)).min(u32::from(BUCKET_SIZE)) as u8;
            *self = Self { tick, tokens: self.tokens.saturating_add(refill).min(BUCKET_SIZE), may_refuse: true };
        }
        if let Some(tokens) = self.tokens.checked_sub(1) {
            self.tokens = tokens;
            Admission::Admitted
        } else if core::mem::take(&mut self.may_refuse) {
            Admission::Refused
        } else {
            Admission::Dropped
        }
    }
}
