//! Which of the host's requests are done, and what each is answered.
//!
//! Bytes from the host may be lost or come twice, and a host repeats a request that got no answer. These rules make a
//! repeated request act once and an old one not at all:
//!
//! - **Numbers go up.** A request whose number is higher than that of the last one done is done. The first one after
//!   boot may have any number.
//! - **A repetition is answered again.** The last request done, coming again whole, gets the answer that it got, and
//!   nothing is done. A refusal by what it asked for (say, not armed) counts as done: to try again takes a new number.
//! - **An older number is late**: [`Refusal::Late`]. So is another request under the last one's number.
//! - **A `Ping` starts the numbers anew**, at its own, once no request was done for [`ANEW_TICKS`]. That is how a
//!   new host begins on a board that was not restarted: it repeats a `Ping` until one is acknowledged. As the pressures
//!   are vented by then, nothing that was sent before can move them.
//! - **At most [`BURST`] requests at once and [`PER_TICK`] a tick** are looked at. One request more in a tick is told
//!   [`Refusal::Busy`], which does not count as done; the rest gets no answer, so that answers to a flood do not fill
//!   the line. A `Disarm` is done even then.
//!
//! The cost of a request is the same few comparisons in every case.

use telemetry::{Command, Outcome, Refusal, Reply, Request};

/// How long no request must have been done before a `Ping` starts the numbers anew, in ticks of 10 ms.
pub const ANEW_TICKS: u32 = 150;

/// Most requests that are looked at in one tick, after a pause.
pub const BURST: u8 = 8;

/// Requests a tick that are looked at for ever.
pub const PER_TICK: u8 = 2;

/// The host's requests, as the board has seen them.
///
/// ```
/// use board_core::Link;
/// use telemetry::{Command, Outcome, Reply, Request};
///
/// let mut link = Link::new();
/// let mut tares = 0;
/// let request = Request { id: 7, command: Command::Tare };
/// for tick in 0..2 {
///     // The host did not hear the first answer and asks again.
///     let reply = link.answer(&request, tick, |_| {
///         tares += 1;
///         Ok(())
///     });
///     assert_eq!(reply, Some(Reply { id: 7, outcome: Outcome::Ack }));
/// }
/// assert_eq!(tares, 1);
/// ```
#[derive(Debug)]
pub struct Link {
    last: Option<Done>,
    budget: Budget,
}

/// The last request done.
#[derive(Debug)]
struct Done {
    request: Request,
    outcome: Outcome,
    tick: u32,
}

impl Link {
    /// Has seen no request yet.
    pub const fn new() -> Self {
        Self { last: None, budget: Budget { tick: 0, left: BURST, answers_left: true } }
    }

    /// Takes a request that came in this tick, lets `act` do it if it is to be done, and gives the answer to send, if
    /// it gets one.
    pub fn answer(
        &mut self,
        request: &Request,
        tick: u32,
        act: impl FnOnce(Command) -> Result<(), Refusal>,
    ) -> Option<Reply> {
        let grant = self.budget.take(tick);
        let outcome = if grant == Grant::Look || request.command == Command::Disarm {
            self.outcome(request, tick, act)
        } else {
            Outcome::Nack(Refusal::Busy)
        };
        (grant != Grant::Nothing).then_some(Reply { id: request.id, outcome })
    }

    fn outcome(&mut self, request: &Request, tick: u32, act: impl FnOnce(Command) -> Result<(), Refusal>) -> Outcome {
        if let Some(last) = &self.last {
            let anew = request.command == Command::Ping && tick.wrapping_sub(last.tick) >= ANEW_TICKS;
            if !anew && *request == last.request {
                return last.outcome;
            }
            if !anew && request.id <= last.request.id {
                return Outcome::Nack(Refusal::Late);
            }
        }
        let outcome = act(request.command).map_or_else(Outcome::Nack, |()| Outcome::Ack);
        self.last = Some(Done { request: *request, outcome, tick });
        outcome
    }
}

impl Default for Link {
    fn default() -> Self {
        Self::new()
    }
}

/// How many requests may still be looked at.
#[derive(Debug)]
struct Budget {
    tick: u32,
    left: u8,
    /// Whether this tick has not yet told anybody that the board is busy.
    answers_left: bool,
}

/// What a request gets of the budget.
#[derive(Debug, PartialEq, Eq)]
enum Grant {
    /// A look and an answer.
    Look,
    /// An answer.
    Answer,
    /// Neither.
    Nothing,
}

impl Budget {
    fn take(&mut self, tick: u32) -> Grant {
        let ticks = tick.wrapping_sub(self.tick);
        if ticks > 0 {
            let gained = ticks.saturating_mul(u32::from(PER_TICK)).min(u32::from(BURST)) as u8;
            *self = Self { tick, left: self.left.saturating_add(gained).min(BURST), answers_left: true };
        }
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            Grant::Look
        } else if core::mem::take(&mut self.answers_left) {
            Grant::Answer
        } else {
            Grant::Nothing
        }
    }
}
