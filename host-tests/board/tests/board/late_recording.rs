//! A recording from the live page that begins while the firmware runs on the virtual Due.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use board_tests::browser::MonitorRun;
use serde_json::Value;

use crate::tools::replayed;

/// Sends a request of the page itself; returns the body of the answer.
fn request(page: &MonitorRun, method: &str, path: &str, body: &str) -> Value {
    let host = page.origin().trim_start_matches("http://");
    let mut stream = TcpStream::connect(host).expect("the monitor listens");
    let (origin, length) = (page.origin(), body.len());
    let request = format!(
        "{method} {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nContent-Type: application/json\r\n\
         Content-Length: {length}\r\nConnection: close\r\n\r\n{body}"
    );
    stream.write_all(request.as_bytes()).expect("the monitor listens");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("the monitor answers");
    let (head, body) = answer.split_once("\r\n\r\n").expect("the head has an end");
    assert!(head.starts_with("HTTP/1.1 200 "), "{answer}");
    serde_json::from_str(body).unwrap_or_default()
}

/// Waits for a status that satisfies `is_so`, however slow the machine is.
fn wait_for(page: &MonitorRun, is_so: impl Fn(&Value) -> bool) {
    let end = Instant::now() + Duration::from_mins(5);
    loop {
        let status = request(page, "GET", "/status", "");
        if is_so(&status) {
            return;
        }
        assert!(Instant::now() < end, "{status}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_recording_that_begins_while_the_firmware_runs_replays_bit_for_bit_from_its_first_sample() {
    let page = MonitorRun::live(&[]);
    // Some seconds after the first tare.
    wait_for(&page, |status| status["frames"].as_u64() > Some(2000));
    let started = request(&page, "POST", "/record", r#"{"on":true}"#);
    assert_eq!(started["is_comparable"], true, "{started}");
    wait_for(&page, |status| status["recording"]["samples"].as_u64() >= Some(400));
    let done = request(&page, "POST", "/record", r#"{"on":false}"#);
    let samples = done["samples"].as_u64().expect("a number");

    let (equal, report) = replayed(page.folder.path(), done["file"].as_str().expect("a name"));
    assert!(report.contains("\"not_compared\":0"), "{report}");
    // The estimate of the last sample may have come after the end.
    assert!(equal + 1 >= samples && samples >= 400, "{equal} of {samples}: {report}");
}
