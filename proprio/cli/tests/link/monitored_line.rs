//! The board's line through a running monitor: recordings, and pressures.

use std::process::{Command as Program, Stdio};
use std::time::{Duration, Instant};

use proprio_link::{Link, LinkError, Relay, Relayed, RequestError};
use proprio_monitor::{MonitoredLine, RunningMonitor, Token};
use telemetry::{Command, SetPressures};

use super::http::Page;
use super::late_recordings::{Arm, compiled, replayed};
use super::line::{Line, PATIENCE};
use super::running::{running, running_with};

/// Bytes of a read of the link.
const READ: usize = 4096;

/// A link through the monitor.
fn link_through(monitor: &RunningMonitor) -> Link {
    let MonitoredLine { client, name, .. } = monitor.line(false).expect("the monitor answers");
    Link::start_relayed(Box::new(client), name.as_deref(), &[], None).expect("a thread starts").0
}

fn pressures() -> Command {
    Command::SetPressures(SetPressures { pressures_pa: [1000; 6].into_iter().collect(), valid_ms: 300 })
}

/// Posts a request of a page that may drive.
fn control(page: &Page, token: &Token, body: &str) -> (u16, String) {
    let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
    let headers = [("Host", &*host), ("Origin", &*origin), ("Authorization", &*token)];
    let answer = page.request("POST", "/control", &headers, body);
    (answer.status, answer.text())
}

fn token() -> Token {
    Token::new().expect("the system has random numbers")
}

fn is_driven(outcome: &Result<(), LinkError>) -> bool {
    matches!(outcome, Err(LinkError::Request(RequestError::Driven)))
}

/// Runs `proprio record` through the monitor of `page`, and `arm` meanwhile; returns its status, its messages and the file's bytes
/// from the board.
fn record(page: &Page, name: &str, seconds: &str, run: impl FnOnce()) -> (Option<i32>, String, Vec<u8>) {
    let file = page.folder.path().join(name);
    let program = |arguments: &[&str]| {
        let mut program = Program::new(env!("CARGO_BIN_EXE_proprio"));
        program.current_dir(page.folder.path()).env("XDG_RUNTIME_DIR", page.runtime_folder.path()).args(arguments);
        program.stderr(Stdio::piped());
        program
    };
    let recording = program(&["record", "--port", "line 1", "--seconds", seconds, "-o", name]).spawn();
    let end = Instant::now() + PATIENCE;
    while !file.is_file() {
        assert!(Instant::now() < end, "it never begins");
        std::thread::sleep(Duration::from_millis(5));
    }
    run();
    let output = recording.expect("the tool starts").wait_with_output().expect("it ends");
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    let converted = program(&["convert", name, "bytes.bin"]).output().expect("the tool starts");
    assert!(converted.status.success(), "{messages}{}", String::from_utf8_lossy(&converted.stderr));
    let bytes = std::fs::read(page.folder.path().join("bytes.bin")).expect("it was written");
    (output.status.code(), messages, bytes)
}

#[test]
fn a_recording_through_a_monitor_has_the_board_s_bytes_and_is_replayed_bit_for_bit_from_its_first_sample() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let (page, _monitor) = running(&line);
    let mut arm = Arm::new(&config, 150);
    arm.run(&line, 1500);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 1500);
    let (code, messages, bytes) = record(&page, "a.mcap", "2", || arm.run(&line, 600));
    assert_eq!(code, Some(0), "{messages}");
    assert!(messages.contains("through the monitor at http://") && messages.contains("600 samples"), "{messages}");
    assert!(messages.contains("0 frames lost, 0 damaged") && !messages.contains("warning"), "{messages}");
    assert!(line.board().read.ends_with(&bytes), "{} bytes are not those of the board", bytes.len());

    let (session, stderr) = replayed(&page.folder.path().join("a.mcap"));
    let recorded = &session["recorded"];
    assert_eq!((&session["samples"], &recorded["estimates"]), (&600.into(), &600.into()), "{stderr}");
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&600.into(), &0.into()), "{stderr}");
}

#[test]
fn a_recording_through_a_monitor_that_joined_the_board_late_warns_of_samples_that_no_replay_can_compare() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let mut arm = Arm::new(&config, 150);
    let (page, _monitor) = running(&line);
    arm.run(&line, 300);
    // A sample is lost.
    arm.run(&Line::new(), 1);
    line.board().lose_frame();
    arm.run(&line, 300);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 600);
    let (code, messages, _) = record(&page, "a.mcap", "2", || arm.run(&line, 200));
    assert_eq!(code, Some(0), "{messages}");
    // The recording begins with the next whole frame, which is the estimate of the first sample.
    assert!(messages.contains("199 samples are before a tare") && messages.contains("0 damaged"), "{messages}");
}

#[test]
fn a_recording_through_a_monitor_that_ends_is_whole_until_then_and_says_why_it_ended() {
    let (line, compiled) = (Line::new(), compiled());
    let config = compiled.config();
    let (page, _monitor) = running(&line);
    let mut arm = Arm::new(&config, 150);
    arm.run(&line, 200);
    page.wait_for_status(|_| page.get("/history").about()["rows"] == 200);
    let Page { monitor, folder, runtime_folder } = page;
    let mut program = Program::new(env!("CARGO_BIN_EXE_proprio"));
    program.current_dir(folder.path()).env("XDG_RUNTIME_DIR", runtime_folder.path());
    let recording = program.args(["record", "--port", "line 1", "-o", "a.mcap"]).stderr(Stdio::piped()).spawn();
    while !folder.path().join("a.mcap").is_file() {
        std::thread::sleep(Duration::from_millis(5));
    }
    drop(monitor);
    let output = recording.expect("the tool starts").wait_with_output().expect("it ends");
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{messages}");
    assert!(messages.contains("through which the board was reached, has ended"), "{messages}");
    let (session, stderr) = replayed(&folder.path().join("a.mcap"));
    assert_eq!(session["recorded"]["first_difference"], serde_json::Value::Null, "{stderr}");
}

/// More than the system holds for a connection that nobody reads, and than the monitor's queue.
#[test]
fn a_program_that_reads_slowly_learns_how_many_events_it_has_lost() {
    let line = Line::new();
    let (page, monitor) = running(&line);
    let MonitoredLine { mut client, .. } = monitor.line(false).expect("the monitor answers");
    let reads = 16_000;
    let send = |bytes: &[u8]| {
        let all = line.board().read.len() + bytes.len();
        line.board().send_bytes(bytes);
        page.wait_for_status(|_| line.board().read.len() == all);
    };
    // A program gets the bytes behind the end of a frame.
    send(&[0]);
    send(&vec![1; reads * READ]);
    let (mut received, mut dropped, end) = (0, 0, Instant::now() + PATIENCE);
    while received + dropped * READ < reads * READ {
        match client.next().expect("the monitor runs") {
            Some(Relayed::Bytes(_, bytes)) => received += bytes.len(),
            Some(Relayed::Dropped(events)) => dropped += events as usize,
            _ => assert!(Instant::now() < end, "{received} bytes, {dropped} events dropped"),
        }
    }
    assert!(dropped > 0);
    assert_eq!(received + dropped * READ, reads * READ);
}

#[test]
fn a_program_drives_through_a_monitor_whose_page_may_not() {
    let line = Line::new();
    let (_page, monitor) = running(&line);
    let link = link_through(&monitor);
    for command in [Command::Arm, pressures(), Command::Disarm] {
        link.request(command.clone()).expect("the board does it");
        assert_eq!(line.board().done.last(), Some(&command));
    }
}

#[test]
fn while_a_program_drives_other_programs_and_pages_are_refused_and_the_page_may_vent() {
    let (line, token) = (Line::new(), token());
    let (page, monitor) = running_with(&line, Some(token.clone()));
    let (drive, other) = (link_through(&monitor), link_through(&monitor));
    drive.request(Command::Arm).expect("the board does it");
    assert!(is_driven(&other.request(Command::Arm)) && is_driven(&other.request(pressures())));
    let (status, text) = control(&page, &token, r#""arm""#);
    assert_eq!((status, text.contains("driven by another program")), (409, true), "{text}");
    drive.request(pressures()).expect("the board does it");
    assert!(line.board().done.iter().filter(|command| **command == Command::Arm).count() == 1);
    assert_eq!(control(&page, &token, r#""vent""#).0, 200);
    assert_eq!(line.board().done.last(), Some(&Command::Disarm));
}

#[test]
fn while_a_page_drives_a_program_is_refused() {
    let (line, token) = (Line::new(), token());
    let (page, monitor) = running_with(&line, Some(token.clone()));
    let drive = link_through(&monitor);
    assert_eq!(control(&page, &token, r#""arm""#).0, 200);
    assert!(is_driven(&drive.request(Command::Arm)));
    assert_eq!(control(&page, &token, r#""vent""#).0, 200);
    drive.request(Command::Arm).expect("nobody else drives");
}

#[test]
fn a_program_that_ends_leaves_the_control_to_others() {
    let (line, token) = (Line::new(), token());
    let (page, monitor) = running_with(&line, Some(token.clone()));
    let drive = link_through(&monitor);
    drive.request(Command::Arm).expect("the board does it");
    let armed = Instant::now();
    drop(drive);
    while control(&page, &token, r#""arm""#).0 != 200 {
        assert!(armed.elapsed() < Duration::from_secs(1), "its control has outlived it");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Sends a command to a monitor whose board does not answer, ends the connection, and lets the board answer; returns the board's
/// commands.
fn done_after_the_end_of_the_program(command: Command) -> Vec<Command> {
    let line = Line::new();
    let (page, monitor) = running_with(&line, Some(token()));
    line.board().answers_lost = usize::MAX;
    let link = link_through(&monitor);
    // It is repeated until it is given up, and the next one waits behind it.
    let first = link.begin_request(Command::Ping);
    let second = link.begin_request(command);
    std::thread::sleep(Duration::from_millis(300));
    drop(link);
    std::thread::sleep(Duration::from_millis(300));
    drop((first, second));
    line.board().answers_lost = 0;
    // Requests are sent in their order.
    page.monitor.finish().expect("nothing was recorded");
    line.board().done.clone()
}

#[test]
fn a_request_of_a_program_that_has_gone_is_not_sent() {
    let done = done_after_the_end_of_the_program(Command::Arm);
    assert!(done.contains(&Command::Disarm) && !done.contains(&Command::Arm), "{done:?}");
}

#[test]
fn the_line_is_for_this_user_s_programs_alone() {
    let line = Line::new();
    let (page, _monitor) = running(&line);
    let origin = page.origin();
    assert_eq!(page.socket_at("/board/line", Some(&origin), "0").err(), Some(401));
    assert_eq!(page.socket_at("/board/line", Some("http://example.com"), "0").err(), Some(403));
    assert_eq!(page.socket_at("/board/line", None, "0").err(), Some(403));
}
