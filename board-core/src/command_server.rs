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
//! - **A session ends** when no request was executed for [`SESSION_TIMEOUT_TICKS`]; the pressures are vented by then. A
//!   `Ping`, of any number, begins the next one, and each reply has its number. A request of another session, or after
//!   its end, is refused as [`Refusal::Session`]: bytes that are delayed, or received again, move nothing. A new host
//!   begins with a `Ping`, repeated until one is acknowledged.
//! - **A token bucket limits the rate**: [`BUCKET_SIZE`] requests at once, and [`REFILL_PER_TICK`] more each tick. One
//!   more request in a tick is refused as [`Refusal::Busy`], which does not count as execution; the rest get no reply,
//!   so that replies to a flood do not fill the line.
//! - **A `Disarm` is always executed**: with any number, in any session, in a flood.
//!
//! The cost of a request is the same few comparisons in every case.

use telemetry::{Command, Refusal, Reply, Request, RequestOutcome};

/// Ticks of 10 ms without an executed request after which a session ends.
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
/// let mut server = CommandServer::new(1);
/// let ping = Request { id: 6, session: 0, command: Command::Ping };
/// let session = server.answer(&ping, 0, |_| Ok(Execution::Done)).map(|reply| reply.session);
/// assert_eq!(session, Some(0x101));
///
/// let mut tares = 0;
/// let request = Request { id: 7, session: 0x101, command: Command::Tare(TareMode::Force) };
/// for tick in 0..2 {
///     // The first reply was lost, and the host repeats the request.
///     let reply = server.answer(&request, tick, |_| {
///         tares += 1;
///         Ok(Execution::Done)
///     });
///     assert_eq!(reply, Some(Reply { id: 7, session: 0x101, outcome: RequestOutcome::Ack }));
/// }
/// assert_eq!(tares, 1);
/// ```
#[derive(Debug)]
pub struct CommandServer {
    /// Number of the session.
    session: u16,
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
    /// It was executed, and its set-points were limited.
    Limited,
    /// Another task executes it; its reply follows.
    Pending,
}

impl CommandServer {
    /// A server that has received no request, in the boot of this number since power-on. Its sessions count up from 256
    /// times that number, so that none has a number of an earlier boot.
    pub const fn new(boot: u32) -> Self {
        let bucket = TokenBucket { tick: 0, tokens: BUCKET_SIZE, may_refuse: true };
        Self { session: (boot as u16) << 8, last: None, bucket }
    }

    /// Number of the session.
    pub const fn session(&self) -> u16 {
        self.session
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
        outcome.filter(|_| admission != Admission::Dropped).map(|outcome| Reply {
            id: request.id,
            session: self.session,
            outcome,
        })
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
        let is_quiet = self.last.as_ref().is_none_or(|last| tick.wrapping_sub(last.tick) >= SESSION_TIMEOUT_TICKS);
        if is_quiet && request.command == Command::Ping {
            self.session = self.session.wrapping_add(1);
        } else if let Some(last) = self.last.as_ref().filter(|last| *request == last.request) {
            return last.outcome;
        } else if let Some(refusal) = self.refusal(request, is_quiet) {
            let is_disarm = request.command == Command::Disarm;
            return if is_disarm { outcome_of(execute(&request.command)) } else { Some(RequestOutcome::Nack(refusal)) };
        }
        let outcome = outcome_of(execute(&request.command));
        self.last = Some(LastRequest { request: request.clone(), outcome, tick });
        outcome
    }

    /// Reason to refuse a request for its session, which is over if `is_quiet`, or its number.
    fn refusal(&self, request: &Request, is_quiet: bool) -> Option<Refusal> {
        if request.command != Command::Ping && (is_quiet || request.session != self.session) {
            return Some(Refusal::Session);
        }
        let is_late = self.last.as_ref().is_some_and(|last| request.id <= last.request.id);
        is_late.then_some(Refusal::Late)
    }
}

/// Outcome to reply; `None`: it follows.
fn outcome_of(result: Result<Execution, Refusal>) -> Option<RequestOutcome> {
    match result {
        Ok(Execution::Done) => Some(RequestOutcome::Ack),
        Ok(Execution::Limited) => Some(RequestOutcome::Limited),
        Ok(Execution::Pending) => None,
        Err(refusal) => Some(RequestOutcome::Nack(refusal)),
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
