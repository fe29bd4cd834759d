//! Tare of a board, from the program and from the page.

use proprio_link::{Link, TareError, tare};
use proprio_monitor::Token;
use serde_json::{Value, json};
use telemetry::{Command, Refusal, TareMode, TareReport};

use super::http::{Answer, Page};
use super::line::Line;

/// An angle in the units of a report.
fn bits(degrees: f64) -> i32 {
    (degrees.to_radians() * f64::from(1 << 26)).round() as i32
}

fn at_rest() -> TareReport {
    TareReport { id: 0, turned: Some((1, bits(0.1))), bent: Some((2, bits(1.3))) }
}

fn in_motion() -> TareReport {
    TareReport { turned: Some((3, bits(5.2))), ..at_rest() }
}

const SENTENCE: &str = "tared: still within 0.1° (segment 2), straight within 1.3° (segment 3)";

fn tares(line: &Line) -> Vec<Command> {
    line.board().done.iter().filter(|command| matches!(command, Command::Tare(_))).cloned().collect()
}

#[test]
fn a_tare_reports_the_pose_of_the_arm() {
    let line = Line::new();
    line.board().pose = Some(at_rest());
    let (link, _events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    let tared = tare(&link, TareMode::IfStill).expect("the arm rests");
    assert_eq!(tared.to_string(), SENTENCE);
    assert_eq!(tares(&line), [Command::Tare(TareMode::IfStill)]);
}

#[test]
fn an_arm_that_moves_is_not_tared_and_its_segment_is_named() {
    let line = Line::new();
    (line.board().pose, line.board().refuses) = (Some(in_motion()), Some(Refusal::Moving));
    let (link, _events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    let error = tare(&link, TareMode::IfStill).expect_err("the arm moves");
    assert!(matches!(error, TareError::Moving(Some(_))), "{error}");
    assert_eq!(error.to_string(), "the arm moves: segment 4 turned by 5.2° in half a second");
}

fn post(page: &Page, token: &Token, body: &str) -> Answer {
    let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
    let headers = [("Host", &*host), ("Origin", &*origin), ("Authorization", &*token)];
    page.request("POST", "/tare", &headers, body)
}

fn outcome(answer: &Answer) -> Value {
    assert_eq!(answer.status, 200, "{}", answer.text());
    serde_json::from_slice(&answer.body).expect("JSON")
}

#[test]
fn the_page_shows_the_same_sentences_and_tares_a_moving_arm_by_force() {
    let line = Line::new();
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);

    line.board().pose = Some(at_rest());
    let tared = outcome(&post(&page, &token, r#"{"force":false}"#));
    assert_eq!(tared, json!({ "is_moving": false, "text": SENTENCE }));

    (line.board().pose, line.board().refuses) = (Some(in_motion()), Some(Refusal::Moving));
    let refused = outcome(&post(&page, &token, r#"{"force":false}"#));
    assert_eq!(refused["is_moving"], true);
    let text = refused["text"].as_str().expect("a text");
    assert!(text.starts_with("the arm moves: segment 4 turned by 5.2° in half a second"), "{text}");

    line.board().refuses = None;
    let forced = outcome(&post(&page, &token, r#"{"force":true}"#));
    assert_eq!(forced["text"], "tared: still within 5.2° (segment 4), straight within 1.3° (segment 3)");
    assert_eq!(tares(&line), [TareMode::IfStill, TareMode::Force].map(Command::Tare));
}

#[test]
fn the_token_is_needed_to_tare() {
    let line = Line::new();
    let page = Page::of(&line, Some(Token::new().expect("the system has random numbers")));
    assert_eq!(page.post("/tare", r#"{"force":true}"#).status, 401);
    assert_eq!(Page::of(&Line::new(), None).post("/tare", r#"{"force":true}"#).status, 403);
    assert_eq!(tares(&line), []);
}
