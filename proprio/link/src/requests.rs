//! The host's side of requests: one after the other, each under its own id and repeated until it is answered. The pieces of
//! a table alone are sent ahead of their replies, so that the line is never idle.
//!
//! A host begins with a Ping: no other request is sent before one is acknowledged. No request outlives the run of the board
//! that it was made for, its time limit, or its asker: one that arms the pressures must not arrive when nobody expects it.

use std::collections::VecDeque;
use std::sync::Weak;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use telemetry::{Command, Encoder, MAX_FRAME, PROTOCOL_VERSION, Refusal, Reply, Request, RequestOutcome};

/// Time without an answer after which a request is sent again.
const AGAIN: Duration = Duration::from_millis(100);

/// Time from the asking after which a request fails, whether or not it was sent.
pub const TIME_LIMIT: Duration = Duration::from_secs(2);

/// A request that was not acknowledged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
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
    /// Another handle of the link drives the pressures.
    #[error("the arm is driven by another program, or from the live page")]
    Driven,
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
    pub fn is_awaited(&self, now: Instant) -> bool {
        now < self.deadline && self.asker.strong_count() > 0
    }

    /// Sends the outcome to the asker.
    pub fn send(&self, outcome: Result<(), RequestError>) {
        // The asker may have left.
        let _ = self.sender.send(outcome);
    }
}

/// Pieces of a table under way at once: they fill less than the board's receive buffer.
const PIECES_AHEAD: usize = 2;

/// The requests that wait, and those under way.
#[derive(Debug, Default)]
pub struct Requests {
    encoder: Encoder,
    /// Version of the protocol that the encoder writes, once the board's is known; until then the newest.
    version: Option<u8>,
    last_id: u32,
    is_connected: bool,
    /// The board's session, from its reply to a Ping; `None`: a Ping is sent first.
    session: Option<u16>,
    /// In the order in which they were sent; more than one are pieces of a table.
    under_way: VecDeque<UnderWay>,
    waiting: VecDeque<(Command, Answer)>,
}

#[derive(Debug)]
struct UnderWay {
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

    /// Sets the version of the protocol that the board uses, once it is known. Requests under way are repeated in it.
    pub fn set_version(&mut self, version: Option<u8>) {
        if version.is_some_and(|version| self.version.unwrap_or(PROTOCOL_VERSION) != version) {
            self.encoder = Encoder::for_version(version.unwrap_or(PROTOCOL_VERSION));
        }
        self.version = version.or(self.version);
    }

    /// True once the board has acknowledged a Ping since its start.
    pub fn is_connected(&self) -> bool {
        self.is_connected
    }

    /// The bytes to send now, if any: a zero, which ends the rest of a damaged frame, and a frame.
    pub fn due(&mut self, now: Instant) -> Option<Vec<u8>> {
        self.give_up(now);
        if self.may_begin() {
            self.begin(now);
        }
        let place = self.under_way.iter().position(|one| one.due <= now)?;
        let due = self.under_way.get_mut(place)?;
        due.due = now + AGAIN;
        let mut buffer = [0; MAX_FRAME];
        let Ok(frame) = self.encoder.encode(&due.request, &mut buffer) else {
            // Of all requests, a board of protocol 2 has none for other numbers of regulators than six.
            self.finish(place, Err(Refusal::Regulators.into()));
            return None;
        };
        Some([&[0], frame].concat())
    }

    /// Ends the requests for whose answer nobody waits any more.
    fn give_up(&mut self, now: Instant) {
        let is_over = |one: &UnderWay| one.answer.as_ref().is_some_and(|answer| !answer.is_awaited(now));
        while let Some(place) = self.under_way.iter().position(is_over) {
            self.finish(place, Err(RequestError::NoAnswer));
        }
        self.waiting.retain(|(_, answer)| {
            let is_awaited = answer.is_awaited(now);
            if !is_awaited {
                answer.send(Err(RequestError::NoAnswer));
            }
            is_awaited
        });
    }

    /// True where nothing is under way, or pieces of a table alone and the next one is another.
    fn may_begin(&self) -> bool {
        let is_piece = |command: &Command| matches!(command, Command::TableWrite(_));
        let next = self.waiting.front().is_some_and(|(command, _)| is_piece(command));
        let pieces_alone = self.under_way.iter().all(|one| is_piece(&one.request.command));
        self.under_way.is_empty() || (next && pieces_alone && self.under_way.len() < PIECES_AHEAD)
    }

    /// Adds the next request to those under way.
    fn begin(&mut self, now: Instant) {
        let (command, answer) = if self.session.is_some() {
            let Some((command, answer)) = self.waiting.pop_front() else { return };
            (command, Some(answer))
        } else {
            (Command::Ping, None)
        };
        self.last_id = self.last_id.wrapping_add(1);
        let request = Request { id: self.last_id, session: self.session.unwrap_or_default(), command };
        self.under_way.push_back(UnderWay { request, answer, due: now });
    }

    /// Handles a reply of the board.
    pub fn replied(&mut self, reply: Reply) {
        let Some(place) = self.under_way.iter().position(|one| one.request.id == reply.id) else { return };
        let is_handshake = self.under_way.get(place).is_some_and(|one| one.answer.is_none());
        match reply.outcome {
            // Limited set-points are accepted, and `Health` has the limit: sensors may be lost for a moment.
            RequestOutcome::Ack | RequestOutcome::Limited => {
                (self.is_connected, self.session) = (true, Some(reply.session));
                self.finish(place, Ok(()));
            }
            // The board has not processed it: it is sent again.
            RequestOutcome::Nack(Refusal::Busy) => {}
            // An earlier host has used higher ids. The board accepts a Ping with a lower one after its session timeout.
            RequestOutcome::Nack(_) if is_handshake => {}
            // Nothing was sent for a while, so that the session is over: the next one begins with a Ping.
            RequestOutcome::Nack(Refusal::Session) => self.begin_session(),
            RequestOutcome::Nack(refusal) => self.finish(place, Err(refusal.into())),
        }
    }

    /// Lets the requests under way wait for the next session.
    fn begin_session(&mut self) {
        self.session = None;
        while let Some(UnderWay { request, answer, .. }) = self.under_way.pop_back() {
            if let Some(answer) = answer {
                self.waiting.push_front((request.command, answer));
            }
        }
    }

    /// Ends all requests after a restart of the board or the loss of its line; none of them is sent again.
    pub fn interrupt(&mut self) {
        while !self.under_way.is_empty() {
            self.finish(0, Err(RequestError::Interrupted));
        }
        for (_, answer) in self.waiting.drain(..) {
            answer.send(Err(RequestError::Interrupted));
        }
        (self.is_connected, self.session) = (false, None);
    }

    /// Ends the request at a place among those under way.
    fn finish(&mut self, place: usize, outcome: Result<(), RequestError>) {
        if let Some(answer) = self.under_way.remove(place).and_then(|one| one.answer) {
            answer.send(outcome);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::mpsc::{Receiver, TryRecvError, channel};

    use telemetry::{Decoder, SetPressures, TableChunk, TareMode, protocol_2};

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
        requests.replied(Reply { id, session: 7, outcome: RequestOutcome::Ack });
    }

    const TARE: Command = Command::Tare(TareMode::IfStill);

    fn pressures_of(regulators: usize) -> Command {
        Command::SetPressures(SetPressures {
            pressures_pa: std::iter::repeat_n(0, regulators).collect(),
            valid_ms: 300,
        })
    }

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
        let pressures = ask(&mut requests, pressures_of(6), after(300));
        assert_eq!(sent(&mut requests, start).map(|request| request.command), Some(Command::Arm));
        assert_eq!(sent(&mut requests, after(2000)).map(|request| request.command), Some(pressures_of(6)));
        assert_eq!(arm.outcome.try_recv(), Ok(Err(RequestError::NoAnswer)));
        assert_eq!(sent(&mut requests, after(2300)), None);
        assert_eq!(pressures.outcome.try_recv(), Ok(Err(RequestError::NoAnswer)));
    }

    fn piece(offset: u32) -> Command {
        Command::TableWrite(TableChunk { offset, bytes: [].into_iter().collect() })
    }

    #[test]
    fn two_pieces_of_a_table_are_under_way_at_once_and_no_other_request_beside_them() {
        let (mut requests, now) = (Requests::default(), Instant::now());
        let ping = sent(&mut requests, now);
        acknowledge(&mut requests, ping);
        let asked: Vec<_> = [piece(0), piece(1), piece(2), Command::TableCommit]
            .into_iter()
            .map(|command| ask(&mut requests, command, now))
            .collect();
        let (first, second) = (sent(&mut requests, now), sent(&mut requests, now));
        assert_eq!(second.as_ref().map(|request| request.command.clone()), Some(piece(1)));
        assert_eq!(sent(&mut requests, now), None);
        acknowledge(&mut requests, first);
        let third = sent(&mut requests, now);
        assert_eq!(third.as_ref().map(|request| request.command.clone()), Some(piece(2)));
        acknowledge(&mut requests, second);
        assert_eq!(sent(&mut requests, now), None, "the commit waits for the last piece");
        acknowledge(&mut requests, third);
        assert_eq!(sent(&mut requests, now).map(|request| request.command), Some(Command::TableCommit));
        assert_eq!(asked[2].outcome.try_recv(), Ok(Ok(())));
    }

    #[test]
    fn a_request_refused_for_its_session_is_sent_again_in_the_next_one() {
        let (mut requests, start) = (Requests::default(), Instant::now());
        let ping = sent(&mut requests, start);
        acknowledge(&mut requests, ping);
        let tare = ask(&mut requests, TARE, start);
        let first = sent(&mut requests, start).expect("a tare");
        assert_eq!(first.session, 7);
        requests.replied(Reply { id: first.id, session: 8, outcome: RequestOutcome::Nack(Refusal::Session) });
        let ping = sent(&mut requests, start).expect("a Ping");
        assert_eq!(ping.command, Command::Ping);
        requests.replied(Reply { id: ping.id, session: 9, outcome: RequestOutcome::Ack });
        let again = sent(&mut requests, start).expect("the tare");
        assert_eq!((again.session, again.command), (9, TARE));
        requests.replied(Reply { id: again.id, session: 9, outcome: RequestOutcome::Ack });
        assert_eq!(tare.outcome.try_recv(), Ok(Ok(())));
    }

    #[test]
    fn set_points_that_the_board_limits_are_done() {
        let (mut requests, now) = (Requests::default(), Instant::now());
        let ping = sent(&mut requests, now);
        acknowledge(&mut requests, ping);
        let asked = ask(&mut requests, pressures_of(6), now);
        let id = sent(&mut requests, now).expect("set-points").id;
        requests.replied(Reply { id, session: 7, outcome: RequestOutcome::Limited });
        assert_eq!(asked.outcome.try_recv(), Ok(Ok(())));
    }

    #[test]
    fn a_request_whose_asker_has_left_is_dropped() {
        let (mut requests, start) = (Requests::default(), Instant::now());
        let ping = sent(&mut requests, start);
        let arm = ask(&mut requests, Command::Arm, start);
        let tare = ask(&mut requests, TARE, start);
        acknowledge(&mut requests, ping);
        drop(arm.asker);
        let next = sent(&mut requests, start);
        assert_eq!(next.as_ref().map(|request| request.command.clone()), Some(TARE));
        acknowledge(&mut requests, next);
        assert_eq!(tare.outcome.try_recv(), Ok(Ok(())));
    }

    /// Version of the frame that is sent at a time, if any.
    fn sent_version(requests: &mut Requests, now: Instant) -> Option<u8> {
        // A zero, the distance to the next zero, and the version.
        requests.due(now)?.get(2).copied()
    }

    #[test]
    fn requests_are_of_the_newest_version_until_the_boards_is_known_and_are_repeated_in_that() {
        let (mut requests, start) = (Requests::default(), Instant::now());
        let after = |ms| start + Duration::from_millis(ms);
        assert_eq!(sent_version(&mut requests, start), Some(PROTOCOL_VERSION));
        requests.set_version(Some(protocol_2::VERSION));
        assert_eq!(sent_version(&mut requests, after(100)), Some(protocol_2::VERSION));
        requests.set_version(None);
        assert_eq!(sent_version(&mut requests, after(200)), Some(protocol_2::VERSION), "a new line, the same board");
        requests.set_version(Some(PROTOCOL_VERSION));
        assert_eq!(sent_version(&mut requests, after(300)), Some(PROTOCOL_VERSION));
    }

    #[test]
    fn set_points_that_the_boards_version_cannot_hold_are_refused_at_once() {
        let (mut requests, now) = (Requests::default(), Instant::now());
        let ping = sent(&mut requests, now);
        acknowledge(&mut requests, ping);
        requests.set_version(Some(protocol_2::VERSION));
        let asked = ask(&mut requests, pressures_of(4), now);
        assert_eq!(requests.due(now), None);
        assert_eq!(asked.outcome.try_recv(), Ok(Err(RequestError::Refused(Refusal::Regulators))));
    }
}
