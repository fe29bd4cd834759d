//! Findings of the session check on the page: of a live board, and of the sessions that are opened.

use std::path::Path;

use proprio_session::LoadedTable;
use proprio_simulation::Simulation;
use rig_twin::Scenario;
use serde_json::Value;
use telemetry::{Message, Sample};

use super::http::Page;
use super::line::Line;
use super::sessions::{page, session};

const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml");

/// Sends 20 s of samples of a board, whose multiplexer may give IMU 3 for IMU 4 as well.
fn send_one_channel(line: &Line, ticks: std::ops::Range<u32>, tare_epoch: u8, is_one_channel: bool) {
    let simulation = Simulation::new(Scenario::FreeSwing, 7, 20.0, 100.0).expect("a valid run");
    for (tick, read) in ticks.zip(simulation) {
        let (bend, mut imu) = (read.counts, read.quaternions);
        if is_one_channel {
            imu[3] = imu[2];
        }
        let time_us = u64::from(tick) * 10_000;
        line.board().send(&Message::Sample(Sample { tick, time_us, tare_epoch, bend, imu }));
    }
}

fn findings(of: &Value) -> Vec<&str> {
    // There is no status before the first one.
    of["findings"].as_array().into_iter().flatten().map(|finding| finding.as_str().expect("a text")).collect()
}

#[test]
fn a_fault_of_a_live_board_is_found_until_its_next_tare() {
    let line = Line::new();
    let table = LoadedTable::load(Path::new(TABLE)).expect("the reference table");
    let page = Page::with_table(&line, None, Some(table));
    line.board().restart(1);
    send_one_channel(&line, 0..2000, 0, true);
    let status = page.wait_for_status(|status| !findings(status).is_empty() && status["lost"] == 0);
    assert!(findings(&status)[0].starts_with("imu3 and imu4, "), "{status}");
    send_one_channel(&line, 2000..4000, 1, false);
    page.wait_for_status(|status| findings(status).is_empty());
}

#[test]
fn a_session_that_is_opened_has_its_findings_in_the_whole_of_it() {
    let page = page(None);
    let good = page.get("/session?name=a%20b.csv").about();
    assert_eq!(good["findings"], serde_json::json!([]));

    let text = std::fs::read_to_string(session("scenario-1.csv")).expect("a committed file");
    let column = |name: &str| text.split('\n').next().and_then(|head| head.split(',').position(|of| of == name));
    let (from, to) = (column("imu3_deg").expect("a column"), column("imu4_deg").expect("a column"));
    let copied = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[to] = cells[from];
        cells.join(",")
    };
    let rows: Vec<String> = text.lines().skip(1).map(copied).collect();
    let head = text.lines().next().expect("a header");
    // Without a line end at its end.
    std::fs::write(page.folder.path().join("same.csv"), format!("{head}\n{}", rows.join("\n"))).expect("there is room");
    for part in ["", "&from_s=1&to_s=2"] {
        let about = page.get(&format!("/session?name=same.csv{part}")).about();
        let [line_end, same] = findings(&about)[..] else { panic!("{about}") };
        assert!(line_end.starts_with("the last line has no end"), "{about}");
        assert!(same.starts_with("imu3 and imu4, "), "{about}");
    }
}
