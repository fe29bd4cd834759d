//! Whom the live page's server answers, and for whom it drives the board.

use proprio_monitor::Token;
use telemetry::{Command, SetPressures};

use super::http::Page;
use super::line::Line;

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
    let pressures = SetPressures { pressures_pa: [1000, 0, 0, 2500, 0, 0], valid_ms: 500 };
    let done = line.board().done.clone();
    let done: Vec<_> = done.iter().filter(|command| **command != Command::Ping).collect();
    assert_eq!(done, [&Command::Arm, &Command::SetPressures(pressures), &Command::Disarm]);
}

#[test]
fn the_board_s_refusal_is_returned() {
    let line = Line::new();
    let token = Token::new().expect("the system has random numbers");
    let page = Page::of(&line, Some(token.clone()));
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);
    line.board().refuses = true;
    let (host, origin, token) = (page.host(), page.origin(), format!("Bearer {token}"));
    let headers = [("Host", &*host), ("Origin", &*origin), ("Authorization", &*token)];
    let answer = page.request("POST", "/control", &headers, r#""arm""#);
    assert_eq!(answer.status, 409);
    assert!(answer.text().contains("not armed"), "{}", answer.text());
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
