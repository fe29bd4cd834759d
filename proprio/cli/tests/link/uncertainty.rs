//! Uncertainty and contacts of the arm on the page and in the status.

use proprio_link::Link;
use proprio_link::status::Status;
use serde_json::Value;
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

#[test]
fn the_page_receives_the_board_s_covariances_and_contact_before_the_next_of_them() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    let arm = socket.arm();
    let value = |rows: &Value, name: &str| {
        let columns = arm["columns"].as_array().expect("names");
        let place = columns.iter().position(|column| column == name).unwrap_or_else(|| panic!("{name}"));
        rows["rows"][0][1][place].as_f64()
    };
    send_ticks(&line, 0..1);
    let rows = socket.next("rows");
    assert!(value(&rows, "end6_xx_mm2").is_none() && value(&rows, "in_contact2").is_none(), "{rows}");

    line.board().send(&uncertainty(0));
    send_ticks(&line, 1..2);
    let rows = socket.next("rows");
    let is_near = |name: &str, expected: f64| value(&rows, name).is_some_and(|value| (value - expected).abs() < 1e-3);
    for (name, expected) in
        [("end6_xx_mm2", 1.0), ("end6_xy_mm2", 0.0), ("end6_yy_mm2", 4.0), ("contact2_percent", 3.0)]
    {
        assert!(is_near(name, expected), "{name}: {rows}");
    }
    // 0.1 rad.
    assert!(is_near("theta1_deviation_deg", 5.7296), "{rows}");
    assert_eq!(value(&rows, "in_contact2"), Some(0.0));

    line.board().send(&Message::Event(Event::Contact(2, 0b10)));
    send_ticks(&line, 2..3);
    let rows = socket.next("rows");
    assert_eq!((value(&rows, "in_contact2"), value(&rows, "in_contact3")), (Some(1.0), Some(0.0)));
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
    assert_eq!(shape.touched, [false, true, false, false, false, false]);
    // χ² of two degrees of freedom: 95 % are within 2.448 standard deviations.
    let tip = shape.tip.expect("it is known");
    assert!((tip.major_mm - 2.0 * 2.448).abs() < 1e-3 && (tip.minor_mm - 2.448).abs() < 1e-3, "{tip:?}");
    let theta_deg = shape.theta_sd_deg[0].expect("it is known");
    assert!((theta_deg - 0.1_f64.to_degrees()).abs() < 1e-3, "{theta_deg}");
}
