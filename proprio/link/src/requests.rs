//! The host's side of requests: one after the other, each under its own id and repeated until it is answered.
//!
//! A host begins with a Ping: no other request is sent before one is acknowledged. No request outlives the run of the board
//! that it was made for, its time limit, or its asker: one that arms the pressures must not arrive when nobody expects it.

use std::collections::VecDeque;
use std::sync::Weak;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use telemetry::{Command, Encoder, MAX_FRAME, Outcome, Refusal, Reply, Request};

/// Time without an answer after which a request is sent again.
const AGAIN: Duration = Duration::from_millis(100);

/// Time from the asking after which a request fails, whether or not it was sent.
pub const TIME_LIMIT: Duration = Duration::from_secs(2);

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

/// The way back to the asker of a request.
#[derive(Debug)]
pub struct Answer {
    /// Channel for the outcome.
    pub sender: Sender<Result<(), RequestError>>,
    /// The asker, who has left when it is dropped.
    pub asker: Weak<()>,
    /// Time from which on nobody waits for the outcome.
    pub deadline: Instant,
}

impl Answer {
    /// True while the asker waits.
    fn is_awaited(&self, now: Instant) -> bool {
        now < self.deadline && self.asker.strong_count() > 0
    }

    fn send(&self, outcome: Result<(), RequestError>) {
        // The asker may have left.
        let _ = self.sender.send(outcome);
    }
}

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
        self.give_up(now);
        if self.current.is_none() {
            self.begin(now)?;
        }
        let current = self.current.as_mut().filter(|current| current.due <= now)?;
        current.due = now + AGAIN;
        let mut buffer = [0; MAX_FRAME];
        let frame = self.encoder.encode(&current.request, &mut buffer).ok()?;
        Some([&[0], frame].concat())
    }

    /// Ends the requests for whose answer nobody waits any more.
    fn give_up(&mut self, now: Instant) {
        let answer = self.current.as_ref().and_then(|current| current.answer.as_ref());
        if answer.is_some_and(|answer| !answer.is_awaited(now)) {
            self.finish(Err(RequestError::NoAnswer));
        }
        self.waiting.retain(|(_, answer)| {
            let is_awaited = answer.is_awaited(now);
            if !is_awaited {
                answer.send(Err(RequestError::NoAnswer));
            }
            is_awaited
        });
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
        self.current = Some(Current { request, answer, due: now });
        Some(())
    }

    /// Handles a reply of the board.
    pub fn replied(&mut self, reply: Reply) {
        let Some(current) = self.current.as_ref().filter(|current| current.request.id == reply.id) else { return };
        match reply.outcome {
            Outcome::Ack => {
                self.is_connected = true;
                self.finish(Ok(()));
            }
            // The board has not processed it: it is sent again.
            Outcome::Nack(Refusal::Busy) => {}
            // An earlier host has used higher ids. The board accepts a Ping with a lower one after its session timeout.
            Outcome::Nack(_) if current.answer.is_none() => {}
            Outcome::Nack(refusal) => self.finish(Err(refusal.into())),
        }
    }

    /// Ends all requests after a restart of the board or the loss of its line; none of them is sent again.
    pub fn interrupt(&mut self) {
        self.finish(Err(RequestError::Interrupted));
        for (_, answer) in self.waiting.drain(..) {
            answer.send(Err(RequestError::Interrupted));
        }
        self.is_connected = false;
    }

    fn finish(&mut self, outcome: Result<(), RequestError>) {
        if let Some(answer) = self.current.take().and_then(|current| current.answer) {
            answer.send(outcome);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::mpsc::{Receiver, TryRecvError, channel};

    use telemetry::{Decoder, SetPressures};

    use super::*;

    /// A request with its asker and the channel of its outcome.
    struct Asked {
        asker: Arc<()>,
        outcome: Receiver<Result<(), RequestError>>,
    }

    fn ask(requests: &mut Requests, command: Command, now: Instant) -> Asked {
        let (asker, (sender, outcome)) = (Arc::new(()), channel());
        requests.push(command, Answer { sender, asker: Arc::downgrade(&asker), deadline: now + TIME_LIMIT });
        Asked { asker, outcome }
    }

    /// The request that is sent at a time, if any.
    fn sent(requests: &mut Requests, now: Instant) -> Option<Request> {
        let mut decoder = Decoder::<Request>::new();
        requests.due(now)?.into_iter().find_map(|byte| decoder.push(byte)).and_then(Result::ok)
    }

    fn acknowledge(requests: &mut Requests, request: Option<Request>) {
        let id = request.expect("a request was sent").id;
        requests.replied(Reply { id, outcome: Outcome::Ack });
    }

    const PRESSURES: Command = Command::SetPressures(SetPressures { pressures_pa: [0; 6], valid_ms: 300 });

    #[test]
    fn a_request_that_was_made_before_the_board_answers_is_given_up_two_seconds_after_the_asking() {
        let (mut requests, start) = (Requests::default(), Instant::now());
        let after = |ms| start + Duration::from_millis(ms);
        let arm = ask(&mut requests, Command::Arm, start);
        for ms in [0, 500, 1000, 1500, 1999] {
            assert_eq!(sent(&mut requests, after(ms)).map(|request| request.command), Some(Command::Ping));
        }
        assert_eq!(arm.outcome.try_recv(), Err(TryRecvError::Empty));
        sent(&mut requests, after(2000));
        assert_eq!(arm.outcome.try_recv(), Ok(Err(RequestError::NoAnswer)));

        let ping = sent(&mut requests, after(20_000));
        acknowledge(&mut requests, ping);
        assert_eq!(sent(&mut requests, after(20_001)), None, "the board answers, and gets nothing of old");
    }

    #[test]
    fn a_request_behind_another_is_given_up_two_seconds_after_its_own_asking() {
        let (mut requests, start) = (Requests::default(), Instant::now());
        let after = |ms| start + Duration::from_millis(ms);
        let ping = sent(&mut requests, start);
        acknowledge(&mut requests, ping);
        let arm = ask(&mut requests, Command::Arm, start);
        let pressures = ask(&mut requests, PRESSURES, after(300));
        assert_eq!(sent(&mut requests, start).map(|request| request.command), Some(Command::Arm));
        assert_eq!(sent(&mut requests, after(2000)).map(|request| request.command), Some(PRESSURES));
        assert_eq!(arm.outcome.try_recv(), Ok(Err(RequestError::NoAnswer)));
        assert_eq!(sent(&mut requests, after(2300)), None);
        assert_eq!(pressures.outcome.try_recv(), Ok(Err(RequestError::NoAnswer)));
    }

    #[test]
    fn a_request_whose_asker_has_left_is_dropped() {
        let (mut requests, start) = (Requests::default(), Instant::now());
        let ping = sent(&mut requests, start);
        let arm = ask(&mut requests, Command::Arm, start);
        let tare = ask(&mut requests, Command::Tare, start);
        acknowledge(&mut requests, ping);
        drop(arm.asker);
        let next = sent(&mut requests, start);
        assert_eq!(next.as_ref().map(|request| request.command), Some(Command::Tare));
        acknowledge(&mut requests, next);
        assert_eq!(tare.outcome.try_recv(), Ok(Ok(())));
    }
}
