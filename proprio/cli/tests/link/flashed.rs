//! A board that was flashed is judged by its `Hello`.

use proprio::flash::{FlashError, verify};
use proprio_link::{Link, Mismatch};
use telemetry::{Hello, Message};

use super::line::{Line, hello, text};

fn judged(sent: Hello) -> Result<Hello, FlashError> {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    line.board().send(&Message::Hello(sent));
    verify(&link, &events)
}

#[test]
fn the_version_that_was_flashed_is_a_success_with_any_table() {
    assert_eq!(judged(hello(1)).expect("it is the one"), hello(1));
    let erased = Hello { arm: text(""), table: 0, ..hello(1) };
    assert_eq!(judged(erased.clone()).expect("it is the one"), erased);
}

#[test]
fn another_version_is_reported_although_its_messages_are_the_same() {
    let error = judged(Hello { firmware: text("0.9.0"), ..hello(1) }).expect_err("it is another");
    assert!(matches!(&error, FlashError::Other(Mismatch::Firmware(version)) if version == "0.9.0"), "{error}");
}

#[test]
fn another_layout_of_the_messages_is_reported() {
    let error = judged(Hello { schema: 1, ..hello(1) }).expect_err("it is another");
    assert!(matches!(&error, FlashError::Other(Mismatch::Schema { board: Some(1), .. })), "{error}");
}

#[test]
fn a_board_without_messages_is_reported_as_silent() {
    let (link, events) = Link::start(Box::new(Line::new()), None).expect("memory opens");
    let error = verify(&link, &events).expect_err("nothing came");
    assert!(matches!(&error, FlashError::Silent { port, .. } if port == "line 1"), "{error}");
}
