//! A cable that comes and goes.

use proprio_link::{EventKind, Link, LinkError, RequestError};
use telemetry::{Command, Message, TareMode};

use super::line::{Line, hello, sample, wait_for};

const TARE: Command = Command::Tare(TareMode::IfStill);

fn opened(what: &EventKind) -> Option<String> {
    match what {
        EventKind::Opened(name) => Some(name.clone()),
        _ => None,
    }
}

#[test]
fn a_line_that_comes_back_is_opened_again_under_its_new_name() {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    assert_eq!(wait_for(&events, opened), "line 1");
    line.board().restart(1);
    (0..50).for_each(|tick| line.board().send(&Message::Sample(sample(tick))));
    wait_for(&events, |what| {
        matches!(what, EventKind::Message(Message::Sample(last)) if last.tick == 49).then_some(())
    });

    line.board().unplugged = true;
    let reason = wait_for(&events, |what| match what {
        EventKind::Lost(reason) => Some(reason.clone()),
        _ => None,
    });
    assert!(reason.starts_with("line 1: "), "{reason}");
    assert_eq!(link.state().port, None);
    let asked = link.request(TARE);
    assert!(matches!(asked, Err(LinkError::Request(RequestError::Interrupted))), "{asked:?}");

    line.board().restart(2);
    line.board().unplugged = false;
    assert_eq!(wait_for(&events, opened), "line 2");
    wait_for(&events, |what| matches!(what, EventKind::Restarted).then_some(()));
    link.request(TARE).expect("it is is_connected and answers");
    let state = link.state();
    assert_eq!((state.port.as_deref(), state.reopened, state.restarts), (Some("line 2"), 1, 1));
    // The frames of both openings, and none of between.
    assert_eq!((state.counts.lost, state.counts.damaged), (0, 0));
    assert!(state.counts.received >= 53, "{:?}", state.counts);
    assert_eq!(state.hello, Some(hello(2)));
}

/// A board that had its power by the cable numbers its boots from 1 again, and its ticks may be as low as before.
#[test]
fn a_board_that_lost_its_power_with_the_cable_has_restarted_however_short_it_ran() {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    line.board().restart(1);
    (0..20).for_each(|tick| line.board().send(&Message::Sample(sample(tick))));
    wait_for(&events, |what| {
        matches!(what, EventKind::Message(Message::Sample(last)) if last.tick == 19).then_some(())
    });
    line.board().unplugged = true;
    wait_for(&events, |what| matches!(what, EventKind::Lost(_)).then_some(()));

    line.board().restart(1);
    (0..5).for_each(|tick| line.board().send(&Message::Sample(sample(tick))));
    line.board().unplugged = false;
    wait_for(&events, |what| matches!(what, EventKind::Restarted).then_some(()));
    wait_for(&events, |what| matches!(what, EventKind::Message(Message::Sample(last)) if last.tick == 4).then_some(()));
    link.request(TARE).expect("it is is_connected and answers");
    assert_eq!((link.state().restarts, link.state().counts.lost), (1, 0));
}

#[test]
fn a_line_that_cannot_be_opened_at_first_is_an_error_at_once() {
    let line = Line::new();
    line.board().unplugged = true;
    assert!(matches!(Link::start(Box::new(line), None), Err(LinkError::Gone)));
}
