//! `proprio monitor` before there is a page; what the page does is tested with the link.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::process::Stdio;

use super::common::{Folder, table};

const SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../host-tests/sessions/scenario-1.csv");

#[test]
fn a_session_without_a_table_is_refused() {
    let folder = Folder::with("session.csv", "time_s\n");
    let error = folder.refused(&["monitor", "session.csv"]);
    assert_eq!(error, "a session is shown with the estimates of a replay, which needs a table");
}

#[test]
fn a_session_that_is_not_there_is_refused_before_anything_is_served() {
    let error = Folder::new().refused(&["monitor", "missing.csv", "--table", table(), "--listen", "0"]);
    assert!(error.starts_with("missing.csv: "), "{error}");
}

#[test]
fn a_port_that_is_taken_is_named() {
    let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let port = taken.local_addr().expect("it has one").port().to_string();
    let error = Folder::new().refused(&["monitor", SESSION, "--table", table(), "--listen", &port]);
    assert!(error.starts_with(&format!("port {port} of 127.0.0.1 cannot be listened on: ")), "{error}");
}

#[test]
fn what_makes_no_sense_together_is_refused() {
    for extra in ["--virtual", "--allow-control", "--plain", "--port=x", "--foxglove"] {
        let run = Folder::new().run(&["monitor", "session.csv", extra]);
        assert_eq!(run.code, Some(2), "{extra}: {}", run.stderr);
        assert!(run.stderr.contains("cannot be used with"), "{extra}: {}", run.stderr);
    }
}

#[test]
fn the_page_of_a_session_is_at_the_printed_address() {
    let folder = Folder::new();
    let mut command = folder.command(&["monitor", SESSION, "--table", table(), "--listen", "0"]);
    let mut monitor = command.stdout(Stdio::piped()).spawn().expect("the tool starts");
    let mut address = String::new();
    BufReader::new(monitor.stdout.take().expect("a pipe")).read_line(&mut address).expect("it prints its address");
    let host = address.trim().trim_start_matches("http://").trim_end_matches('/');
    let mut stream = TcpStream::connect(host).expect("it listens");
    write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").expect("it listens");
    let mut answer = String::new();
    stream.read_to_string(&mut answer).expect("it answers");
    monitor.kill().expect("it runs");
    monitor.wait().expect("it ends");
    assert!(answer.starts_with("HTTP/1.1 200 OK") && answer.contains("<title>proprio monitor</title>"), "{answer}");
}
