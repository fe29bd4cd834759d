//! Uncertainty and contacts of the arm on the page and in the status.

use proprio_link::Link;
use proprio_link::status::Status;
use proprio_session::CHI2_2_95;
use serde_json::{Value, json};
use telemetry::{Event, Message, SegmentUncertainty, Uncertainty};

use super::http::Page;
use super::line::{Line, sample};
use super::page::{health, send_ticks};

/// The segments' ends are known to 1 mm to the right and 2 mm along the base's tangent, and nothing touches them.
fn uncertainty(tick: u32) -> Message {
    // mm² in units of 2⁻³² m², and 0.01 rad² in as many of rad².
    let end = [4295, 0, 4 * 4295];
    let segment = SegmentUncertainty { theta: Some(42_949_673), end: Some(end), contact_percent: 3, in_contact: false };
    Message::Uncertainty(Uncertainty { tick, segments: [segment; 6].into_iter().collect() })
}

const NONE: [bool; 6] = [false; 6];
const SECOND: [bool; 6] = [false, true, false, false, false, false];

#[test]
fn the_page_receives_the_board_s_covariances_and_contact_before_the_next_of_them() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    let sigmas = socket.next("arm")["ellipse_sigmas"].as_f64().expect("a number");
    assert!((sigmas - CHI2_2_95.sqrt()).abs() < 1e-12 && (sigmas - 2.4477).abs() < 1e-4, "{sigmas}");
    send_ticks(&line, 0..1);
    let rows = socket.next("rows");
    assert!(rows["uncertainty"].is_null() && rows["contact"].is_null(), "{rows}");

    line.board().send(&uncertainty(0));
    send_ticks(&line, 1..2);
    let rows = socket.next("rows");
    let ends = rows["uncertainty"]["ends_m2"].as_array().expect("ends");
    assert_eq!((ends.len(), &rows["contact"]), (6, &json!(NONE)));
    let is_near = |value: &Value, square_mm: f64| (value.as_f64().expect("a number") * 1e6 - square_mm).abs() < 1e-3;
    assert!(is_near(&ends[5][0], 1.0) && is_near(&ends[5][1], 0.0) && is_near(&ends[5][2], 4.0), "{rows}");

    line.board().send(&Message::Event(Event::Contact(2, 0b10)));
    send_ticks(&line, 2..3);
    assert_eq!(socket.next("rows")["contact"], json!(SECOND));
}

#[test]
fn status_has_the_uncertainty_of_the_tip_and_the_contacts() {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    line.board().restart(1);
    line.board().send(&Message::Health(health(0, telemetry::SensorState::Ok)));
    line.board().send(&uncertainty(0));
    line.board().send(&Message::Event(Event::Contact(1, 0b10)));
    for tick in 0..200 {
        line.board().send(&Message::Sample(sample(tick)));
    }
    let status = Status::of(&link, &events, false).expect("the board has sent its status");
    let shape = status.shape.expect("the board has sent an uncertainty");
    assert_eq!(shape.touched, SECOND);
    // χ² of two degrees of freedom: 95 % are within 2.448 standard deviations.
    let tip = shape.tip.expect("it is known");
    assert!((tip.major_mm - 2.0 * 2.448).abs() < 1e-3 && (tip.minor_mm - 2.448).abs() < 1e-3, "{tip:?}");
    let theta_deg = shape.theta_sd_deg[0].expect("it is known");
    assert!((theta_deg - 0.1_f64.to_degrees()).abs() < 1e-3, "{theta_deg}");
}
