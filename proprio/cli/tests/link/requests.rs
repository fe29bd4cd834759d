//! Requests: acknowledged, repeated, refused, given up.

use std::time::{Duration, Instant};

use proprio_link::{EventKind, Link, LinkError, RequestError};
use telemetry::{Command, Message, Refusal, TareMode};

use super::line::{Line, PATIENCE, hello, sample, wait_for};

const TARE: Command = Command::Tare(TareMode::IfStill);

fn wait_until(is_so: impl Fn() -> bool) {
    let end = Instant::now() + PATIENCE;
    while !is_so() {
        assert!(Instant::now() < end, "it never came");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn start(line: &Line) -> (Link, proprio_link::Subscription) {
    Link::start(Box::new(line.clone()), None).expect("memory opens")
}

#[test]
fn a_link_begins_with_a_ping_and_repeats_it_until_it_is_acknowledged() {
    let line = Line::new();
    line.board().answers_lost = 3;
    let (link, _events) = start(&line);
    link.request(TARE).expect("it is done");
    let board = line.board();
    assert_eq!(board.done, [Command::Ping, TARE]);
    let pings = board.received.iter().filter(|request| request.command == Command::Ping);
    assert_eq!(pings.map(|request| request.id).collect::<Vec<_>>(), [1; 4]);
    drop(board);
    assert!(link.state().is_connected);
}

#[test]
fn a_request_whose_answer_was_lost_is_sent_again_and_acts_once() {
    let line = Line::new();
    let (link, _events) = start(&line);
    link.request(Command::Ping).expect("it is done");
    line.board().answers_lost = 2;
    link.request(TARE).expect("it is done");
    let board = line.board();
    assert_eq!(board.received.iter().filter(|request| request.command == TARE).count(), 3);
    assert_eq!(board.done.iter().filter(|command| **command == TARE).count(), 1);
}

#[test]
fn a_refusal_is_returned_with_its_reason() {
    let line = Line::new();
    line.board().refuses = Some(Refusal::Disarmed);
    let (link, _events) = start(&line);
    let refused = link.request(Command::Arm);
    assert!(matches!(refused, Err(LinkError::Request(RequestError::Refused(Refusal::Disarmed)))), "{refused:?}");
}

#[test]
fn a_board_that_does_not_answer_is_given_up() {
    let line = Line::new();
    let (link, _events) = start(&line);
    link.request(Command::Ping).expect("it is done");
    line.board().answers_lost = usize::MAX;
    let given_up = link.request(TARE);
    assert!(matches!(given_up, Err(LinkError::Request(RequestError::NoAnswer))), "{given_up:?}");
}

#[test]
fn a_request_that_was_given_up_does_not_reach_a_board_that_answers_later() {
    let line = Line::new();
    line.board().answers_lost = usize::MAX;
    let (link, _events) = start(&line);
    let given_up = link.request(Command::Arm);
    assert!(matches!(given_up, Err(LinkError::Request(RequestError::NoAnswer))), "{given_up:?}");
    line.board().answers_lost = 0;
    wait_until(|| link.state().is_connected);
    link.request(TARE).expect("it is done");
    assert_eq!(line.board().done.iter().filter(|command| **command != Command::Ping).collect::<Vec<_>>(), [&TARE]);
}

/// To arm must not outlive the run of the board that it was meant for.
#[test]
fn a_request_does_not_outlive_a_restart() {
    let line = Line::new();
    let (link, events) = start(&line);
    line.board().send(&Message::Hello(hello(1)));
    link.request(Command::Ping).expect("it is done");
    line.board().answers_lost = usize::MAX;
    std::thread::scope(|scope| {
        let arming = scope.spawn(|| link.request(Command::Arm));
        while !line.board().received.iter().any(|request| request.command == Command::Arm) {
            std::thread::sleep(Duration::from_millis(1));
        }
        line.board().restart(2);
        let interrupted = arming.join().expect("no panic");
        assert!(matches!(interrupted, Err(LinkError::Request(RequestError::Interrupted))), "{interrupted:?}");
    });
    wait_for(&events, |kind| matches!(kind, EventKind::Restarted).then_some(()));
    let arms = || line.board().received.iter().filter(|request| request.command == Command::Arm).count();
    let before = arms();
    line.board().answers_lost = 0;
    link.request(TARE).expect("the new run is is_connected and answers");
    assert_eq!(arms(), before);
}

/// As it is where the board was not restarted: another host's ids were higher.
#[test]
fn a_board_that_has_seen_higher_ids_is_greeted_after_its_pause() {
    let line = Line::new();
    let (first, _events) = start(&line);
    for _ in 0..5 {
        first.request(TARE).expect("it is done");
    }
    drop(first);
    let (second, _events) = start(&line);
    wait_until(|| second.state().is_connected);
    second.request(Command::Disarm).expect("it is done");
    assert_eq!(line.board().done.last(), Some(&Command::Disarm));
}

#[test]
fn a_slow_subscriber_loses_the_oldest_events_and_delays_no_other() {
    let line = Line::new();
    let (link, slow) = start(&line);
    let fast = link.subscribe();
    let mut received = 0;
    for tick in 0..10_000 {
        line.board().send(&Message::Sample(sample(tick)));
        if tick % 100 == 99 {
            let is_last =
                |kind: &EventKind| matches!(kind, EventKind::Message(Message::Sample(last)) if last.tick == tick);
            wait_for(&fast, |kind| {
                received += u32::from(matches!(kind, EventKind::Message(Message::Sample(_))));
                is_last(kind).then_some(())
            });
        }
    }
    assert_eq!((received, fast.dropped()), (10_000, 0));
    assert!(slow.dropped() > 0);
    // The newest events are left.
    let first = wait_for(&slow, |kind| match kind {
        EventKind::Message(Message::Sample(sample)) => Some(sample.tick),
        _ => None,
    });
    assert!(first > 1000, "{first}");
}
