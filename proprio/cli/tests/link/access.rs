//! Whom the live page's server answers, and for whom it drives the board.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};

use proprio_monitor::Token;
use telemetry::{Command, Message, SensorState, SetPressures};

use super::http::Page;
use super::line::{Line, PATIENCE};
use super::page::{health, send_ticks};

#[test]
fn only_this_machine_s_own_names_are_answered() {
    let page = Page::of(&Line::new(), None);
    for host in [page.host(), format!("localhost:{}", page.port())] {
        assert_eq!(page.request("GET", "/", &[("Host", &host)], "").status, 200, "{host}");
    }
    let strangers = [
        "example.com".to_owned(),
        format!("example.com:{}", page.port()),
        "127.0.0.1".to_owned(),
        "127.0.0.1:1".to_owned(),
    ];
    for host in strangers {
        for path in ["/", "/status", "/history", "/sessions"] {
            let answer = page.request("GET", path, &[("Host", &host)], "");
            assert_eq!(answer.status, 403, "{host}{path}");
            assert!(answer.text().contains("answers to no other name"), "{}", answer.text());
        }
    }
    assert_eq!(page.request("GET", "/", &[("Host", &page.host()), ("Host", "example.com")], "").status, 403);
}

#[test]
fn another_page_s_websocket_and_posts_are_refused() {
    let page = Page::of(&Line::new(), None);
    let other_port = format!("http://127.0.0.1:{}", page.port() ^ 1);
    let other_name = format!("http://localhost:{}", page.port());
    for origin in ["http://example.com", "null", &other_port, &other_name] {
        assert_eq!(page.socket(Some(origin)).err(), Some(403), "{origin}");
        for path in ["/record", "/mark", "/control", "/sessions?name=a.csv"] {
            let headers = [("Host", &*page.host()), ("Origin", origin), ("Content-Type", "application/json")];
            assert_eq!(page.request("POST", path, &headers, r#"{"on":true}"#).status, 403, "{origin}{path}");
        }
    }
    assert_eq!(page.socket(None).err(), Some(403));
    assert!(page.socket(Some(&page.origin())).is_ok());
    assert!(page.folder.path().read_dir().expect("a folder").next().is_none(), "nothing was recorded");
}

#[test]
fn a_board_that_is_watched_cannot_be_driven() {
    let line = Line::new();
    let page = Page::of(&line, None);
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);
    let answer = page.post("/control", r#""arm""#);
    assert_eq!(answer.status, 403);
    assert!(answer.text().contains("--allow-control"), "{}", answer.text());
    assert!(line.board().done.iter().all(|command| *command == Command::Ping));
}

#[test]
fn the_token_is_needed_to_drive_the_board() {
    let line = Line::new();
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);
    let control = |token: &str, command: &str| {
        let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
        let headers = [("Host", &*host), ("Origin", &*origin), ("Authorization", &*token)];
        page.request("POST", "/control", &headers, command).status
    };
    let right = token.to_string();
    let wrong = if right.starts_with('0') { right.replacen('0', "1", 1) } else { format!("0{}", &right[1..]) };
    assert_eq!(page.post("/control", r#""arm""#).status, 401);
    for token in ["", &wrong, &right[1..], &format!("{right}0")] {
        assert_eq!(control(token, r#""arm""#), 401, "{token}");
    }
    assert_eq!(control(&right, r#""explode""#), 400);
    assert!(line.board().done.iter().all(|command| *command == Command::Ping));

    assert_eq!(control(&right, r#""arm""#), 200);
    assert_eq!(control(&right, r#"{"set_pressures":{"kpa":[1,0,0,2.5,0,-7]}}"#), 200);
    assert_eq!(control(&right, r#""vent""#), 200);
    let pressures = SetPressures { pressures_pa: [1000, 0, 0, 2500, 0, 0].into_iter().collect(), valid_ms: 500 };
    let done = line.board().done.clone();
    let done: Vec<_> = done.iter().filter(|command| **command != Command::Ping).collect();
    assert_eq!(done, [&Command::Arm, &Command::SetPressures(pressures), &Command::Disarm]);
}

#[test]
fn pressures_that_are_requested_and_set_are_columns_of_the_page_until_the_arm_is_vented() {
    let line = Line::new();
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    let mut socket = page.socket(Some(&page.origin())).expect("its own page");
    line.board().restart(1);
    let mut arm = socket.arm();
    while arm["regulators"] == 0 {
        arm = socket.arm();
    }
    let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
    let headers = [("Host", &host[..]), ("Origin", &origin[..]), ("Authorization", &token[..])];
    let mut pressures = |command: &str, ticks: std::ops::Range<u32>| {
        assert_eq!(page.request("POST", "/control", &headers, command).status, 200);
        line.board().send(&Message::Health(health(0, SensorState::Ok)));
        send_ticks(&line, ticks);
        let rows = socket.next("rows");
        ["pressure2_requested_kpa", "pressure2_set_kpa"].map(|name| {
            let columns = arm["columns"].as_array().expect("names");
            let place = columns.iter().position(|column| column == name).unwrap_or_else(|| panic!("{name}: {arm}"));
            rows["rows"][0][1][place].as_f64()
        })
    };
    let set_kpa = health(0, SensorState::Ok).pressures_pa.get(1).map(|pressure_pa| f64::from(*pressure_pa) / 1e3);
    assert_eq!(pressures(r#"{"set_pressures":{"kpa":[0,12.5,0,0,0,0]}}"#, 0..1), [Some(12.5), set_kpa]);
    assert_eq!(pressures(r#""vent""#, 1..2), [None, set_kpa]);
}

#[test]
fn the_board_s_refusal_is_returned() {
    let line = Line::new();
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);
    line.board().refuses = Some(telemetry::Refusal::Disarmed);
    let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
    let headers = [("Host", &*host), ("Origin", &*origin), ("Authorization", &*token)];
    let answer = page.request("POST", "/control", &headers, r#""arm""#);
    assert_eq!(answer.status, 409);
    assert!(answer.text().contains("not armed"), "{}", answer.text());
}

#[test]
fn a_wrong_token_is_refused_when_the_page_is_unlocked() {
    let line = Line::new();
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    let unlock = |token: &str| {
        let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
        let headers = [("Host", &*host), ("Origin", &*origin), ("Authorization", &*token)];
        page.request("POST", "/unlock", &headers, "null").status
    };
    assert_eq!(page.post("/unlock", "null").status, 401);
    assert_eq!((unlock("0"), unlock(&token.to_string())), (401, 200));
    let watched = Page::of(&Line::new(), None);
    assert_eq!(watched.post("/unlock", "null").status, 403);
}

#[test]
fn a_request_of_a_page_that_has_gone_is_dropped() {
    let line = Line::new();
    line.board().answers_lost = usize::MAX;
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    let body = r#""arm""#;
    let head = format!("POST /control HTTP/1.1\r\nHost: {}\r\nOrigin: {}\r\n", page.host(), page.origin());
    let length = body.len();
    let mut stream = TcpStream::connect(page.monitor.address()).expect("it listens");
    let request = format!("{head}Authorization: Bearer {token}\r\nContent-Length: {length}\r\n\r\n{body}");
    stream.write_all(request.as_bytes()).expect("it listens");
    stream.shutdown(Shutdown::Write).expect("it is open");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("the server closes it");
    line.board().answers_lost = 0;
    page.wait_for_status(|status| status["answers"] == true);
    // Requests are sent in their order.
    page.monitor.finish().expect("nothing was recorded");
    let done = line.board().done.clone();
    assert!(done.contains(&Command::Disarm) && !done.contains(&Command::Arm), "{done:?}");
}

/// The first two as of a program that stops in the middle, the third of a session that would fill the disk.
#[test]
fn half_a_request_times_out_and_a_huge_one_is_refused_at_once() {
    let page = Page::of(&Line::new(), None);
    let (host, origin) = (page.host(), page.origin());
    let post = |path: &str, length: u64| {
        format!("POST {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nContent-Length: {length}\r\n\r\n")
    };
    let answer = |request: String| {
        let mut stream = TcpStream::connect(page.monitor.address()).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        stream.write_all(request.as_bytes()).expect("it listens");
        let mut answer = String::new();
        // Without a timeout of the server this fails after ours.
        stream.read_to_string(&mut answer).expect("the server closes it");
        answer
    };
    std::thread::scope(|scope| {
        let head = scope.spawn(|| answer("GET / HTTP/1.1\r\nHo".to_owned()));
        let body = scope.spawn(|| answer(post("/record", 11) + "{\"on"));
        let session = scope.spawn(|| answer(post("/sessions?name=a.csv", 100) + "time_s"));
        let huge = answer(post("/sessions?name=a.csv", 2_000_000_001));
        assert!(huge.starts_with("HTTP/1.1 413 ") && huge.contains("2000 MB"), "{huge}");
        let long = answer(post("/record", 1_000_001));
        assert!(long.starts_with("HTTP/1.1 413 "), "{long}");
        assert_eq!(head.join().expect("it was closed"), "");
        for half in [body, session] {
            let half = half.join().expect("it was closed");
            assert!(half.starts_with("HTTP/1.1 408 ") && half.contains("within 10 s"), "{half}");
        }
    });
}

#[test]
fn tokens_are_long_and_never_the_same() {
    let token = || Token::new().expect("the system has random numbers").to_string();
    let (one, other) = (token(), token());
    assert_eq!(one.len(), 32);
    assert_ne!(one, other);
}

#[test]
fn ending_a_monitor_that_may_drive_vents_the_board() {
    let line = Line::new();
    let page = Page::of(&line, Some(Token::new().expect("the system has random numbers")));
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);
    page.monitor.finish().expect("nothing was recorded");
    assert_eq!(line.board().done.last(), Some(&Command::Disarm));
}
