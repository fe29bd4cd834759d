//! Data of the live page, and recordings from it.

use std::path::Path;

use proprio_link::{EventKind, Link, LinkEvent};
use proprio_monitor::Plain;
use proprio_session::{HostClock, LoadedTable};
use proprio_simulation::Simulation;
use rig_twin::Scenario;
use telemetry::{
    Actuation, Conditions, Estimate, Health, Message, PressureLimit, Sample, SegmentEstimate, SensorHealth, SensorState,
};

use super::http::Page;
use super::line::{Line, sample, wait_for};

/// 2⁻²⁶ rad or m.
fn bits(value: f64) -> i32 {
    (value * f64::from(1 << 26)) as i32
}

fn estimate(tick: u32) -> Estimate {
    let segment = |i: usize| SegmentEstimate { theta: bits(0.1 * i as f64), end: [bits(0.01 * i as f64), bits(0.1)] };
    Estimate { tick, segments: (0..6).map(|i| Some(segment(i))).collect() }
}

pub fn health(tick: u32, imu_3: SensorState) -> Health {
    let sensor = |state| SensorHealth { state, missed: 5 };
    let mut imu = [sensor(SensorState::Ok); 6];
    imu[2] = sensor(imu_3);
    Health {
        tick,
        bend: [sensor(SensorState::Ok); 12].into_iter().collect(),
        imu: imu.into_iter().collect(),
        max_estimate_latency_us: 5000,
        longest_imu_read_us: 2000,
        load_permille: 123,
        overruns: 0,
        stale_scans: 0,
        dropped_frames: 0,
        damaged_frames: 0,
        unknown_frames: 0,
        bus_recoveries: 0,
        saturations: 0,
        conditions: [Conditions::default(); 6].into_iter().collect(),
        actuation: Actuation::Disarmed,
        limit: PressureLimit::None,
        pressures_pa: [0; 6].into_iter().collect(),
    }
}

pub fn send_ticks(line: &Line, ticks: std::ops::Range<u32>) {
    for tick in ticks {
        let mut board = line.board();
        board.send(&Message::Sample(sample(tick)));
        board.send(&Message::Estimate(estimate(tick)));
    }
}

#[test]
fn the_page_and_all_it_is_made_of_come_from_the_program_alone() {
    let page = Page::of(&Line::new(), None);
    let index = page.get("/");
    assert_eq!(index.status, 200);
    assert!(index.head.contains("content-security-policy: default-src 'none'"), "{}", index.head);
    let mut wanted = vec!["/style.css".to_owned(), "/main.js".to_owned()];
    let mut seen = 0;
    while let Some(path) = wanted.get(seen).cloned() {
        seen += 1;
        let text = page.get(&path);
        assert_eq!(text.status, 200, "{path}");
        let text = text.text();
        assert!(!text.contains("http://") && !text.contains("https://") || path == "/export.js", "{path}");
        for import in text.lines().filter(|line| line.starts_with("import ")) {
            let module = import.split('\'').nth(1).and_then(|name| name.strip_prefix('.')).expect("a module of ours");
            if !wanted.iter().any(|known| known == module) {
                wanted.push(module.to_owned());
            }
        }
    }
    assert!(seen > 10, "{wanted:?}");
}

#[test]
fn samples_and_estimates_come_as_rows_with_named_columns() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    let arm = socket.arm();
    send_ticks(&line, 0..1);
    let rows = socket.next("rows");
    let value = |name: &str| {
        let columns = arm["columns"].as_array().expect("names");
        let place = columns.iter().position(|column| column == name).unwrap_or_else(|| panic!("{name}"));
        rows["rows"][0][1][place].clone()
    };
    let number = |name: &str| value(name).as_f64().unwrap_or_else(|| panic!("{name}: {}", value(name)));
    assert!((number("theta3_deg") - 0.2_f64.to_degrees()).abs() < 1e-3);
    assert!((number("x6_mm") - 50.0).abs() < 1e-3 && (number("y6_mm") - 100.0).abs() < 1e-3);
    assert_eq!(value("bend2b_adc"), 3.0);
    // Without a table there is no replica of the estimator, and there is no camera.
    assert!(value("drift1_deg").is_null() && value("truth1_x_mm").is_null());
    assert!(rows["newest_us"].as_u64().is_some());
}

#[test]
fn the_status_has_the_state_of_every_sensor_and_the_board_s_load() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    line.board().send(&Message::Health(health(0, SensorState::NoResponse)));
    let status = page.wait_for_status(|status| status["sensors"][14]["state"] == "Off");
    assert_eq!(status["sensors"].as_array().map(Vec::len), Some(12 + 6));
    assert_eq!(status["sensors"][14]["reason"], "does not answer, or reads at a rail");
    assert_eq!((&status["sensors"][0]["state"], &status["health"]["load_percent"]), (&"Ok".into(), &12.3.into()));

    // An event has the state before the next Health.
    line.board().send(&Message::Event(telemetry::Event::Bend(4, SensorState::Stuck)));
    page.wait_for_status(|status| status["sensors"][4]["state"] == "Stuck");
}

#[test]
fn a_page_that_is_opened_later_gets_what_came_before() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let columns =
        page.socket(Some(&page.origin())).expect("its own page").arm()["columns"].as_array().map_or(0, Vec::len);
    send_ticks(&line, 0..500);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 500);
    let history = page.get("/history");
    let about = history.about();
    assert_eq!((&about["rows"], &about["columns"]), (&500.into(), &columns.into()));
    let begin = history.body.iter().position(|byte| *byte == b'\n').expect("a line") + 1;
    assert_eq!((begin % 8, history.body.len() - begin), (0, 500 * (8 + 4 * columns)));
    let last = &history.body[begin + 499 * 8..][..8];
    assert_eq!(last, 4.99_f64.to_le_bytes());
}

#[test]
fn the_time_continues_over_a_restart_of_the_board() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    send_ticks(&line, 100..103);
    line.board().restart(2);
    send_ticks(&line, 0..3);
    let mut times = Vec::new();
    while times.len() < 6 {
        let rows = socket.next("rows");
        times.extend(rows["rows"].as_array().expect("rows").iter().map(|row| row[0].as_f64().expect("a time")));
    }
    assert!(times.is_sorted_by(|a, b| a < b), "{times:?}");
    let notes = page.wait_for_status(|status| status["restarts"] == 1)["notes"].to_string();
    assert!(notes.contains("the board has restarted"), "{notes}");
}

#[test]
fn a_page_that_confirms_no_more_misses_old_batches_and_not_the_newest() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    socket.send(r#"{"taken_us":0}"#);
    for tick in 0..150 {
        send_ticks(&line, tick..tick + 1);
        page.wait_for_status(|_| page.get("/history").about()["rows"] == tick + 1);
    }
    while socket.unconfirmed("delivery")["skipped"] == 0 {}
    socket.send(&format!(r#"{{"taken_us":{}}}"#, u64::MAX));
    // The rows that follow those without a confirmation.
    let mut times_s = Vec::new();
    while times_s.last() != Some(&1.49) {
        let rows = socket.unconfirmed("rows");
        times_s.extend(rows["rows"].as_array().expect("rows").iter().map(|row| row[0].as_f64().expect("a time")));
    }
    assert!(times_s.is_sorted() && times_s.len() < 150, "{times_s:?}");
}

#[test]
fn the_time_from_sample_to_screen_is_measured_from_what_pages_report() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    send_ticks(&line, 0..1);
    let newest_us = socket.next("rows")["newest_us"].as_u64().expect("a time");
    std::thread::sleep(std::time::Duration::from_millis(120));
    socket.send(&format!(r#"{{"shown_us":{newest_us}}}"#));
    socket.send("nonsense");
    let latency = loop {
        let delivery = socket.next("delivery");
        if !delivery["latency"].is_null() {
            break delivery["latency"].clone();
        }
    };
    assert!(latency["p50_ms"].as_f64().expect("a number") >= 120.0 && latency["reports"] == 1, "{latency}");
    // The latency of a page is its own.
    let mut other = page.socket(Some(&page.origin())).expect("its own page");
    assert!(other.next("delivery")["latency"].is_null());
}

#[test]
fn what_is_recorded_from_the_page_is_all_that_came_even_if_no_page_keeps_up() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    // A page that never reads.
    let _slow = page.socket(Some(&page.origin())).expect("its own page");
    let started = page.post("/record", r#"{"on":true}"#);
    assert_eq!(started.status, 200, "{}", started.text());
    assert_eq!(page.post("/mark", r#"{"text":"push"}"#).status, 200);
    for round in 0..20 {
        send_ticks(&line, round * 1000..round * 1000 + 1000);
        let frames = u64::from(round + 1) * 2000;
        page.wait_for_status(|status| status["frames"].as_u64() >= Some(frames));
    }
    page.wait_for_status(|status| status["recording"]["samples"] == 20_000);
    let done: serde_json::Value = serde_json::from_slice(&page.post("/record", r#"{"on":false}"#).body).expect("JSON");
    assert_eq!((&done["dropped_events"], &done["marks"]), (&0.into(), &1.into()), "{done}");

    let path = std::path::PathBuf::from(done["file"].as_str().expect("a name"));
    let recording = std::fs::read(&path).expect("it is there");
    let mut ticks = 0;
    let mut marks = Vec::new();
    for message in mcap::MessageStream::new(&recording).expect("it is whole") {
        let message = message.expect("it is whole");
        match message.channel.topic.as_str() {
            "/proprio/samples" => ticks += 1,
            "/proprio/marks" => marks.push(message.data.into_owned()),
            _ => {}
        }
    }
    assert_eq!(ticks, 20_000);
    // CDR: four bytes of what it is, the length with its zero, the text.
    assert_eq!(marks, [b"\0\x01\0\0\x05\0\0\0push\0".to_vec()]);
}

#[test]
fn the_samples_at_the_end_of_a_recording_are_those_in_its_file() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    page.post("/record", r#"{"on":true}"#);
    send_ticks(&line, 0..2000);
    // All have arrived, and may wait in the recorder's queue.
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 2000);
    let done: serde_json::Value = serde_json::from_slice(&page.post("/record", r#"{"on":false}"#).body).expect("JSON");
    assert_eq!(done["samples"], 2000);
}

#[test]
fn a_recording_is_completed_when_the_monitor_ends() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    page.post("/record", r#"{"on":true}"#);
    send_ticks(&line, 0..50);
    page.wait_for_status(|status| status["recording"]["samples"] == 50);
    let file = page.monitor.finish().expect("it can be written").expect("it was recorded");
    let recording = std::fs::read(file).expect("it is there");
    let summary = mcap::Summary::read(&recording).expect("it is whole").expect("it has an index");
    assert!(summary.stats.expect("it has statistics").message_count > 100);
}

#[test]
fn a_line_for_a_terminal_has_the_shape_the_rates_and_what_is_wrong() {
    let line = Line::new();
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    let (mut plain, clock) = (Plain::new(), HostClock::new());
    assert!(plain.line(clock.now(), &link.state()).starts_with("no estimate yet  "));
    line.board().restart(1);
    line.board().send(&Message::Health(health(0, SensorState::NoResponse)));
    send_ticks(&line, 0..1);
    wait_for(&events, |kind| {
        plain.take(&LinkEvent { at: clock.now(), gaps: 0, kind: kind.clone() });
        matches!(kind, EventKind::Message(Message::Estimate(_))).then_some(())
    });
    let shown = plain.line(clock.now(), &link.state());
    assert!(shown.starts_with("θ +0.0 +5.7 +11.5 +17.2 +22.9 +28.6°  tip 50.0 100.0 mm  "), "{shown}");
    assert!(shown.ends_with(" samples/s  0 lost  0 damaged  load 12.3 %  IMU 3 Off"), "{shown}");
    line.board().unplugged = true;
    wait_for(&events, |what| matches!(what, EventKind::Lost(_)).then_some(()));
    assert!(plain.line(clock.now(), &link.state()).starts_with("the line is gone"));
}

#[test]
fn drift_and_innovations_of_a_live_board_are_those_of_its_recording() {
    let line = Line::new();
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml"));
    let page = Page::with_table(&line, None, Some(LoadedTable::load(path).expect("the reference table")));
    line.board().restart(1);
    let columns = page.socket(Some(&page.origin())).expect("its own page").next("arm")["columns"].clone();
    page.post("/record", r#"{"on":true}"#);
    let simulation = Simulation::new(Scenario::Push, 7, 10.0, 100.0).expect("a valid run");
    for (tick, read) in (0..).zip(simulation) {
        let time_us = u64::from(tick) * 10_000;
        let sample = Sample { tick, time_us, tare_epoch: 0, bend: read.counts, imu: read.quaternions };
        line.board().send(&Message::Sample(sample));
    }
    page.wait_for_status(|status| status["recording"]["samples"] == 1000);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 999);
    let live = page.get("/history");
    let done: serde_json::Value = serde_json::from_slice(&page.post("/record", r#"{"on":false}"#).body).expect("JSON");
    let file = Path::new(done["file"].as_str().expect("a name")).file_name().expect("a name").display().to_string();
    let recorded = page.get(&format!("/session?name={file}"));
    assert_eq!(recorded.about()["rows"], 1000);
    for name in ["drift6_deg", "innovation_imu2_deg", "innovation_bend3_deg", "bend1a_adc", "imu4_deg"] {
        let (live, mut recorded) = (live.column(&columns, name), recorded.column(&columns, name));
        // The last row waits for its estimate.
        recorded.pop();
        assert!(live.iter().filter(|bits| !f32::from_bits(**bits).is_nan()).count() > 800, "{name}");
        assert_eq!(live, recorded, "{name}");
    }
}

#[test]
fn a_mark_without_a_recording_is_refused() {
    let page = Page::of(&Line::new(), None);
    let answer = page.post("/mark", r#"{"text":"push"}"#);
    assert_eq!((answer.status, answer.text().contains("begin first")), (409, true), "{}", answer.text());
}
