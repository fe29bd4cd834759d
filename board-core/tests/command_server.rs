//! Requests are idempotent, executed in order, and limited in their rate.

use board_core::{BUCKET_SIZE, CommandServer, Execution, REFILL_PER_TICK, SESSION_TIMEOUT_TICKS};
use proptest::prelude::*;
use telemetry::{Command, Refusal, Reply, Request, RequestOutcome, TareMode};

const LATE: Option<RequestOutcome> = Some(RequestOutcome::Nack(Refusal::Late));
const BUSY: Option<RequestOutcome> = Some(RequestOutcome::Nack(Refusal::Busy));
const STALE: Option<RequestOutcome> = Some(RequestOutcome::Nack(Refusal::Session));
const ACK: Option<RequestOutcome> = Some(RequestOutcome::Ack);

/// A server and the requests that it executed.
struct Board {
    server: CommandServer,
    done: Vec<(u32, Command)>,
}

impl Board {
    /// A board that has received no request.
    fn new() -> Self {
        Self { server: CommandServer::new(1), done: Vec::new() }
    }

    /// A board that has executed a Ping of this number in the first tick.
    fn in_session(id: u32) -> Self {
        let mut board = Self::new();
        assert_eq!(board.send(id, Command::Ping, 0), ACK);
        board.done.clear();
        board
    }

    /// Sends a request of the present session whose command succeeds.
    fn send(&mut self, id: u32, command: Command, tick: u32) -> Option<RequestOutcome> {
        self.send_in(self.server.session(), id, command, tick)
    }

    /// Sends a request of a session whose command succeeds.
    fn send_in(&mut self, session: u16, id: u32, command: Command, tick: u32) -> Option<RequestOutcome> {
        let reply = self.server.answer(&Request { id, session, command }, tick, |command| {
            self.done.push((id, command.clone()));
            Ok(Execution::Done)
        });
        reply.map(|reply: Reply| {
            assert_eq!(reply.id, id);
            reply.outcome
        })
    }
}

#[test]
fn the_first_ping_may_have_any_number() {
    for id in [0, 1, 12_345, u32::MAX] {
        let mut board = Board::new();
        assert_eq!(board.send(id, Command::Ping, 0), ACK);
        assert_eq!(board.done, [(id, Command::Ping)]);
    }
}

#[test]
fn before_the_first_ping_nothing_is_executed_but_a_disarm() {
    let mut board = Board::new();
    assert_eq!(board.send(1, Command::Arm, 0), STALE);
    assert_eq!(board.send(2, Command::Disarm, 0), ACK);
    assert_eq!(board.done, [(2, Command::Disarm)]);
}

#[test]
fn a_repeated_request_gets_its_reply_again_and_is_executed_once() {
    let mut board = Board::in_session(0);
    for tick in [0, 0, 5, 100_000] {
        assert_eq!(board.send(1, Command::Tare(TareMode::Force), tick), ACK);
    }
    assert_eq!(board.done, [(1, Command::Tare(TareMode::Force))]);
}

/// A request in the present session of a board.
fn request(board: &Board, id: u32, command: Command) -> Request {
    Request { id, session: board.server.session(), command }
}

#[test]
fn a_repeated_request_that_was_refused_is_not_executed_again() {
    let mut board = Board::in_session(0);
    let request = request(&board, 1, Command::Arm);
    let refused = Some(RequestOutcome::Nack(Refusal::Disarmed));
    let outcome = |reply: Option<Reply>| reply.map(|reply| reply.outcome);
    assert_eq!(outcome(board.server.answer(&request, 0, |_| Err(Refusal::Disarmed))), refused);
    assert_eq!(outcome(board.server.answer(&request, 1, |_| Ok(Execution::Done))), refused);
}

#[test]
fn limited_set_points_have_an_outcome_of_their_own() {
    let mut board = Board::in_session(0);
    let request = request(&board, 1, Command::Arm);
    let reply = board.server.answer(&request, 0, |_| Ok(Execution::Limited));
    assert_eq!(reply.map(|reply| reply.outcome), Some(RequestOutcome::Limited));
}

#[test]
fn a_request_of_another_task_is_answered_when_it_is_completed() {
    let mut board = Board::in_session(0);
    let request = request(&board, 1, Command::TableCommit);
    assert_eq!(board.server.answer(&request, 0, |_| Ok(Execution::Pending)), None);
    assert_eq!(
        board.server.answer(&request, 1, |_| Ok(Execution::Pending)),
        None,
        "a repetition is not executed again"
    );
    let outcome = RequestOutcome::Nack(Refusal::TableChecksum);
    let reply = Reply { id: 1, session: request.session, outcome };
    board.server.complete(reply);
    assert_eq!(board.server.answer(&request, 2, |_| Ok(Execution::Done)), Some(reply));
}

#[test]
fn a_completed_request_does_not_change_the_outcome_of_a_later_one() {
    let mut board = Board::in_session(0);
    let commit = request(&board, 1, Command::TableCommit);
    board.server.answer(&commit, 0, |_| Ok(Execution::Pending));
    let disarm = request(&board, 2, Command::Disarm);
    let reply = board.server.answer(&disarm, 0, |_| Ok(Execution::Done));
    let outcome = RequestOutcome::Nack(Refusal::TableChecksum);
    board.server.complete(Reply { id: 1, session: commit.session, outcome });
    assert_eq!(board.server.answer(&disarm, 1, |_| Ok(Execution::Done)), reply);
}

#[test]
fn an_older_request_is_late() {
    let mut board = Board::in_session(0);
    board.send(5, Command::Arm, 0);
    assert_eq!(board.send(4, Command::Tare(TareMode::Force), 0), LATE);
    assert_eq!(board.send(0, Command::Ping, 0), LATE);
    assert_eq!(board.done.len(), 1);
}

#[test]
fn another_request_under_the_last_number_is_late() {
    let mut board = Board::in_session(0);
    board.send(5, Command::Arm, 0);
    assert_eq!(board.send(5, Command::Tare(TareMode::Force), 0), LATE);
    assert_eq!(board.done, [(5, Command::Arm)]);
}

#[test]
fn a_disarm_is_executed_whatever_its_number_and_session() {
    let mut board = Board::in_session(0);
    board.send(5, Command::Arm, 0);
    assert_eq!(board.send(5, Command::Disarm, 0), ACK);
    assert_eq!(board.send(1, Command::Disarm, 0), ACK);
    assert_eq!(board.send_in(7, 6, Command::Disarm, 0), ACK);
    assert_eq!(board.done.len(), 4);
}

#[test]
fn numbers_may_have_gaps() {
    let mut board = Board::new();
    for id in [1, 2, 10, 1000] {
        assert_eq!(board.send(id, Command::Ping, 0), ACK);
    }
    assert_eq!(board.done.len(), 4);
}

#[test]
fn a_ping_begins_a_new_session_after_the_timeout() {
    let mut board = Board::in_session(0);
    board.send(900, Command::Arm, 10);
    let earlier = board.server.session();
    assert_eq!(board.send(1, Command::Ping, 10 + SESSION_TIMEOUT_TICKS - 1), LATE);
    // Refused requests do not restart the timeout, so that a host that repeats its ping is accepted.
    assert_eq!(board.send(1, Command::Ping, 10 + SESSION_TIMEOUT_TICKS), ACK);
    assert_ne!(board.server.session(), earlier);
    assert_eq!(board.send(2, Command::Arm, 10 + SESSION_TIMEOUT_TICKS), ACK);
}

#[test]
fn after_the_timeout_a_request_needs_a_new_session() {
    let mut board = Board::in_session(0);
    board.send(1, Command::Arm, 10);
    assert_eq!(board.send(2, Command::Arm, 10 + SESSION_TIMEOUT_TICKS), STALE);
    assert_eq!(board.done.len(), 1);
}

#[test]
fn the_bytes_of_an_earlier_session_do_nothing_when_they_are_received_again() {
    let mut board = Board::in_session(1);
    let session = board.server.session();
    board.send(2, Command::Arm, 5);
    let later = 5 + 2 * SESSION_TIMEOUT_TICKS;
    assert_eq!(board.send_in(0, 1, Command::Ping, later), ACK);
    assert_eq!(board.send_in(session, 2, Command::Arm, later), STALE);
    assert_eq!(board.done.iter().filter(|(_, command)| *command == Command::Arm).count(), 1);
}

#[test]
fn the_sessions_of_two_boots_have_different_numbers() {
    let session = |boot| {
        let mut server = CommandServer::new(boot);
        let ping = Request { id: 1, session: 0, command: Command::Ping };
        server.answer(&ping, 0, |_| Ok(Execution::Done)).map(|reply| reply.session)
    };
    assert_ne!(session(1), session(2));
}

#[test]
fn a_new_host_may_begin_at_the_last_number_of_the_previous_one() {
    let mut board = Board::in_session(1);
    assert_eq!(board.send(1, Command::Ping, SESSION_TIMEOUT_TICKS), ACK);
    assert_eq!(board.done.len(), 1);
}

#[test]
fn a_burst_is_served_and_then_a_steady_rate() {
    let mut board = Board::new();
    let mut served = Vec::new();
    for tick in 0..4 {
        let before = board.done.len();
        for n in 0..100 {
            board.send(tick * 100 + n, Command::Ping, tick);
        }
        served.push(board.done.len() - before);
    }
    let per_tick = usize::from(REFILL_PER_TICK);
    assert_eq!(served, [usize::from(BUCKET_SIZE), per_tick, per_tick, per_tick]);
}

#[test]
fn a_flood_gets_one_busy_reply_a_tick_and_no_other() {
    let mut board = Board::new();
    for id in 0..u32::from(BUCKET_SIZE) {
        assert_eq!(board.send(id, Command::Ping, 0), ACK);
    }
    assert_eq!(board.send(100, Command::Ping, 0), BUSY);
    assert_eq!(board.send(101, Command::Ping, 0), None);
    for id in 102..102 + u32::from(REFILL_PER_TICK) {
        assert_eq!(board.send(id, Command::Ping, 1), ACK);
    }
    assert_eq!(board.send(200, Command::Ping, 1), BUSY);
    assert_eq!(board.send(201, Command::Ping, 1), None);
}

#[test]
fn a_request_refused_as_busy_may_be_sent_again_under_the_same_number() {
    let mut board = Board::new();
    for id in 0..u32::from(BUCKET_SIZE) {
        board.send(id, Command::Ping, 0);
    }
    assert_eq!(board.send(100, Command::Tare(TareMode::Force), 0), BUSY);
    assert_eq!(board.send(100, Command::Tare(TareMode::Force), 1), ACK);
    assert_eq!(board.done.last(), Some(&(100, Command::Tare(TareMode::Force))));
}

#[test]
fn a_disarm_is_executed_during_a_flood() {
    let mut board = Board::new();
    for id in 0..1000 {
        board.send(id, Command::Ping, 0);
    }
    board.send(1000, Command::Disarm, 0);
    assert_eq!(board.done.last(), Some(&(1000, Command::Disarm)));
    assert_eq!(board.send(1000, Command::Disarm, 1), ACK);
    assert_eq!(board.done.len(), usize::from(BUCKET_SIZE) + 1);
}

#[test]
fn a_long_pause_refills_no_more_than_the_bucket() {
    let mut board = Board::new();
    for id in 0..100 {
        board.send(id, Command::Ping, 100_000);
    }
    assert_eq!(board.done.len(), usize::from(BUCKET_SIZE));
}

#[test]
fn a_pause_refills_the_bucket_even_while_the_tick_wraps() {
    let mut board = Board::new();
    for id in 0..100 {
        board.send(id, Command::Ping, u32::MAX);
    }
    let before = board.done.len();
    for id in 100..200 {
        board.send(id, Command::Ping, 10);
    }
    assert_eq!(board.done.len() - before, usize::from(BUCKET_SIZE));
}

/// Next arrival on the line.
#[derive(Debug, Clone)]
enum Arrival {
    /// A new request, after some that are delayed or lost.
    New { skipped: u32 },
    /// A request that was sent before.
    Old { before_newest: u32 },
}

fn arrival() -> impl Strategy<Value = Arrival> {
    prop_oneof![
        (0_u32..3).prop_map(|skipped| Arrival::New { skipped }),
        (0_u32..20).prop_map(|before_newest| Arrival::Old { before_newest }),
    ]
}

proptest! {
    /// Shorter than the timeout of a session.
    #[test]
    fn repeated_and_delayed_requests_are_executed_once_and_in_order(
        arrivals in prop::collection::vec(arrival(), 1..SESSION_TIMEOUT_TICKS as usize),
        first in 20_u32..1000,
    ) {
        // Of one host, each number belongs to one command.
        let command = |id: u32| [Command::Ping, Command::Arm, Command::Reboot, Command::Tare(TareMode::Force)][id as usize % 4].clone();
        let mut board = Board::in_session(0);
        let mut newest = first;
        board.send(first, command(first), 0);
        let mut expected = vec![(first, command(first))];
        for (tick, arrival) in (1..).zip(arrivals) {
            let id = match arrival {
                Arrival::New { skipped } => {
                    newest += 1 + skipped;
                    expected.push((newest, command(newest)));
                    newest
                }
                Arrival::Old { before_newest } => newest - before_newest,
            };
            board.send(id, command(id), tick);
        }
        prop_assert_eq!(board.done, expected);
    }
}
