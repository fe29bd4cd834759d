//! Boards with arms of other numbers of segments and regulators than the reference arm's.

use proprio_link::drive::{DriveError, Driver};
use proprio_link::status::Status;
use proprio_link::{EventKind, Link, Subscription};
use serde_json::json;
use telemetry::{
    Actuation, Command, Conditions, Estimate, Event, Health, Hello, Message, PressureLimit, SegmentUncertainty,
    SensorHealth, SensorState, Uncertainty,
};

use super::http::Page;
use super::line::{Line, hello, sample_of, wait_for};

/// Segments of the arm.
const SEGMENTS: u32 = 3;

fn of_three(boot: u32) -> Hello {
    Hello { segments: 3, bend_sensors: 5, regulators: 4, ..hello(boot) }
}

/// Segment 3 has one bend sensor, and segment 2 no IMU.
fn health(tick: u32) -> Health {
    let state = |is_wired: bool| if is_wired { SensorState::Ok } else { SensorState::NotWired };
    let sensor = |is_wired: bool| SensorHealth { state: state(is_wired), missed: 0 };
    Health {
        tick,
        bend: (0..6).map(|i| sensor(i != 5)).collect(),
        imu: (0..3).map(|i| sensor(i != 1)).collect(),
        max_estimate_latency_us: 5000,
        longest_imu_read_us: 2000,
        load_permille: 80,
        overruns: 0,
        stale_scans: 0,
        dropped_frames: 0,
        damaged_frames: 0,
        unknown_frames: 0,
        bus_recoveries: 0,
        saturations: 0,
        conditions: [Conditions::default(); 3].into_iter().collect(),
        actuation: Actuation::Disarmed,
        limit: PressureLimit::None,
        pressures_pa: [1000, 2000, 3000, 4000].into_iter().collect(),
    }
}

fn send_ticks(line: &Line, ticks: std::ops::Range<u32>) {
    for tick in ticks {
        let mut board = line.board();
        board.send(&Message::Sample(sample_of(SEGMENTS, tick)));
        board.send(&Message::Estimate(Estimate { tick, segments: [None; 3].into_iter().collect() }));
    }
}

/// A link to a board that has sent its status.
fn started(line: &Line) -> (Link, Subscription, Status) {
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    line.board().send(&Message::Hello(of_three(1)));
    line.board().send(&Message::Health(health(0)));
    let segment = SegmentUncertainty { end: Some([4295, 0, 4295]), ..SegmentUncertainty::default() };
    line.board().send(&Message::Uncertainty(Uncertainty { tick: 0, segments: [segment; 3].into_iter().collect() }));
    line.board().send(&Message::Event(Event::Contact(1, 0b100)));
    send_ticks(line, 0..400);
    let status = Status::of(&link, &events, false).expect("the board has sent its status");
    (link, events, status)
}

#[test]
fn status_has_the_numbers_and_the_contact_of_its_segments() {
    let (_link, _events, status) = started(&Line::new());
    let hello = &status.hello;
    assert_eq!((hello.segments, hello.bend_sensors, hello.regulators), (3, 5, 4));
    let shape = status.shape.expect("the board has sent an uncertainty");
    assert_eq!((shape.touched, shape.theta_sd_deg), (vec![false, false, true], vec![None; 3]));
    assert!(shape.tip.is_some());
}

#[test]
fn set_points_have_as_many_values_as_the_board_has_regulators() {
    let line = Line::new();
    let (link, _events, status) = started(&line);
    let mut driver = Driver::arm(&link, &status, 4).expect("the board has four");
    let requested = driver.set(vec![1000, 0, 0, 4000]).expect("it is done");
    assert_eq!(requested.pressures_pa, [1000, 0, 0, 4000]);
    // Each session of the line begins with a Ping.
    let done: Vec<_> = line.board().done.iter().filter(|command| **command != Command::Ping).cloned().collect();
    assert_eq!(done, [Command::Arm, Command::SetPressures(requested)]);
}

#[test]
fn pressures_for_another_number_of_regulators_are_refused_before_the_board_is_armed() {
    let line = Line::new();
    let (link, _events, status) = started(&line);
    let error = Driver::arm(&link, &status, 6).expect_err("the board has four");
    assert!(matches!(error, DriveError::Regulators { given: 6, board: 4 }), "{error}");
    let text = error.to_string();
    assert!(text.contains("pressures for 6 regulators, and the board's arm has 4"), "{text}");
    assert_eq!(line.board().done, [Command::Ping]);
}

#[test]
fn samples_arrive_with_the_segments_of_the_arm() {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    let sent = sample_of(SEGMENTS, 9);
    line.board().send(&Message::Sample(sent.clone()));
    let received = wait_for(&events, |kind| match kind {
        EventKind::Message(Message::Sample(sample)) => Some(sample.clone()),
        _ => None,
    });
    assert_eq!(received, sent);
    drop(link);
}

#[test]
fn the_page_has_the_segments_and_regulators_of_the_board() {
    let line = Line::new();
    let page = Page::of(&line, None);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    line.board().send(&Message::Hello(of_three(1)));
    let arm = socket.arm();
    assert_eq!(arm["segments"], 3);
    let columns = arm["columns"].as_array().expect("names");
    assert!(columns.contains(&json!("theta3_deg")) && !columns.contains(&json!("theta4_deg")), "{arm}");
    line.board().send(&Message::Health(health(0)));
    send_ticks(&line, 0..50);
    let rows = socket.next("rows");
    assert_eq!(rows["rows"][0][1].as_array().map(Vec::len), Some(columns.len()));

    let status = page.wait_for_status(|status| !status["health"].is_null());
    assert_eq!(status["health"]["pressures_kpa"], json!([1.0, 2.0, 3.0, 4.0]));
    let board = &status["board"];
    assert_eq!((&board["segments"], &board["bend_sensors"], &board["regulators"]), (&3.into(), &5.into(), &4.into()));
    let states: Vec<_> = (0..9).map(|i| status["sensors"][i]["state"].as_str().expect("a state")).collect();
    assert_eq!(states.iter().filter(|state| **state == "NotWired").count(), 2, "{states:?}");
}

#[test]
fn a_page_follows_a_board_that_gets_another_arm() {
    let line = Line::new();
    let page = Page::of(&line, None);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    line.board().restart(1);
    assert_eq!(socket.arm()["segments"], 6);
    line.board().send(&Message::Hello(of_three(2)));
    assert_eq!(socket.next("arm")["segments"], 3);
    send_ticks(&line, 0..20);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 20);
    let arm = page.socket(Some(&page.origin())).expect("its own page").arm();
    assert_eq!(page.get("/history").about()["columns"], arm["columns"].as_array().map_or(0, Vec::len));
}
