//! The host's link on a serial port of the system: a board that is reset, and a cable that is unplugged and plugged in again.

use std::os::unix::fs::symlink;
use std::path::Path;
use std::time::Duration;

use proprio_link::{Baud, EventKind, Link, PortSource, Subscription};

use crate::terminal::Terminal;
use crate::tools::folder;

fn open(port: &str) -> (Link, Subscription) {
    let source = PortSource::new(Some(port.to_owned()), Baud::default());
    Link::start(Box::new(source), None).expect("a pseudo-terminal opens")
}

/// Lets the board run until this link has so many frames of it.
fn run_until_received(terminal: &mut Terminal, link: &Link, frames: u32) {
    terminal.run_until(|_| link.state().counts.received >= frames);
}

#[test]
fn a_reset_of_the_board_is_distinguished_from_lost_frames() {
    let mut terminal = Terminal::new();
    let (link, events) = open(terminal.port());
    run_until_received(&mut terminal, &link, 200);
    terminal.machine.press_reset();
    run_until_received(&mut terminal, &link, 400);
    let state = link.state();
    assert_eq!((state.restarts, state.counts.lost, state.reopened), (1, 0, 0));
    assert_eq!(state.hello.map(|hello| hello.boot), Some(2));
    let restarts =
        std::iter::from_fn(|| events.next(Duration::ZERO)).filter(|event| matches!(event.kind, EventKind::Restarted));
    assert_eq!(restarts.count(), 1);
}

/// A port that vanishes and returns under the same name, as udev's links do, with a board that has lost its power meanwhile:
/// its boots are numbered from 1 again.
#[test]
fn a_cable_that_comes_back_is_opened_again_and_nothing_counts_as_lost() {
    let name = folder("cable").join("due");
    let plug = |terminal: &Terminal| symlink(Path::new(terminal.port()), &name).expect("there is room");
    let mut terminal = Terminal::new();
    plug(&terminal);
    let (link, events) = open(&name.display().to_string());
    run_until_received(&mut terminal, &link, 200);

    std::fs::remove_file(&name).expect("it is there");
    drop(terminal);
    let lost = std::iter::from_fn(|| events.next(Duration::from_secs(20)))
        .find(|event| matches!(event.kind, EventKind::Lost(_)));
    assert!(lost.is_some(), "the loss of the line is an event");
    assert_eq!(link.state().port, None);

    let mut terminal = Terminal::new();
    plug(&terminal);
    run_until_received(&mut terminal, &link, 400);
    let state = link.state();
    assert_eq!((state.reopened, state.restarts, state.counts.lost), (1, 1, 0));
    assert!(state.is_connected && state.port.is_some());
}
