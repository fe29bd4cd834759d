//! A board that was flashed is judged by its `Hello`.

use proprio::flash::{FlashError, verify};
use proprio_link::{Link, Mismatch};
use telemetry::{Hello, Message};

use super::line::{Line, hello, text};

/// The checksum of the table that was flashed: the one in `hello`.
const FLASHED: u32 = 7;

fn judged(sent: Hello, flashed: u32) -> Result<Hello, FlashError> {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), Some(flashed)).expect("memory opens");
    line.board().send(&Message::Hello(sent));
    verify(&link, &events)
}

#[test]
fn version_and_table_that_were_flashed_are_a_success() {
    assert_eq!(judged(hello(1), FLASHED).expect("it is the one"), hello(1));
}

#[test]
fn another_table_is_reported_with_both_checksums() {
    let error = judged(hello(1), 8).expect_err("it is another");
    assert!(matches!(&error, FlashError::OtherTable { board: 7, given: 8, .. }), "{error}");
    assert!(error.to_string().starts_with("flashed, but the board has another table"), "{error}");
}

#[test]
fn another_version_is_reported_although_its_messages_are_the_same() {
    let error = judged(Hello { firmware: text("0.9.0"), ..hello(1) }, FLASHED).expect_err("it is another");
    assert!(matches!(&error, FlashError::Other(Mismatch::Firmware(version)) if version == "0.9.0"), "{error}");
}

#[test]
fn a_board_without_messages_is_reported_as_silent() {
    let (link, events) = Link::start(Box::new(Line::new()), Some(FLASHED)).expect("memory opens");
    let error = verify(&link, &events).expect_err("nothing came");
    assert!(matches!(&error, FlashError::Silent { port, .. } if port == "line 1"), "{error}");
}
