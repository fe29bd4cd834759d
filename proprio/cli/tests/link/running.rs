//! Programs of the user that reach the board through a running monitor.

use proprio_monitor::{RunningMonitor, RunningMonitorError, Token};
use telemetry::{Command, Message, Refusal, SensorState, TareMode, TareReport};

use super::http::{Page, STREAM};
use super::line::{Line, sample};
use super::page::health;

/// The page of a board that answers, and its monitor as the user's programs find it.
pub fn running(line: &Line) -> (Page, RunningMonitor) {
    running_with(line, None)
}

/// The same of a page that may drive.
pub fn running_with(line: &Line, token: Option<Token>) -> (Page, RunningMonitor) {
    let page = Page::of(line, token);
    line.board().restart(1);
    page.wait_for_status(|status| status["answers"] == true);
    let monitor = RunningMonitor::find(page.runtime_folder.path(), "line 1").expect("it is announced");
    assert_eq!(monitor.address(), page.monitor.address());
    (page, monitor)
}

#[test]
fn a_program_gets_the_status_of_the_board_from_the_monitor() {
    let line = Line::new();
    let (_page, monitor) = running(&line);
    let status = std::thread::scope(|scope| {
        let status = scope.spawn(|| monitor.status());
        let mut tick = 0;
        while !status.is_finished() {
            let mut board = line.board();
            if tick % 25 == 0 {
                board.send(&Message::Health(health(tick, SensorState::Ok)));
            }
            board.send(&Message::Sample(sample(tick)));
            drop(board);
            tick += 1;
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        status.join().expect("it does not panic")
    });
    let status = status.expect("the monitor answers");
    assert_eq!((status.port.as_str(), status.answers, status.hello.boot), ("line 1", true, 1));
    assert_eq!(status.health.bend.len(), 12);
    assert!((status.rates.samples_hz - 100.0).abs() < 1.0, "{:?}", status.rates);
}

#[test]
fn a_program_tares_the_board_through_a_monitor_whose_page_may_not() {
    let line = Line::new();
    let (page, monitor) = running(&line);
    line.board().pose = Some(TareReport { id: 0, turned: Some((1, 0)), bent: None });
    let tared = monitor.tare(TareMode::IfStill).expect("the arm is still");
    assert_eq!(tared, "tared: still within 0.0° (segment 2), no bend sensor was read");
    assert_eq!(line.board().done.last(), Some(&Command::Tare(TareMode::IfStill)));
    assert_eq!(page.post("/tare", r#"{"force":false}"#).status, 403);

    line.board().refuses = Some(Refusal::Moving);
    let moving = monitor.tare(TareMode::IfStill).expect_err("the arm moves");
    assert!(matches!(moving, RunningMonitorError::Moving(_)), "{moving}");
    assert!(moving.to_string().starts_with("the arm moves"), "{moving}");
}

#[test]
fn a_program_finds_the_stream_of_the_monitor_that_has_the_line() {
    let line = Line::new();
    let (_page, monitor) = running(&line);
    assert_eq!(monitor.stream(), Some(STREAM));
}

#[test]
fn a_program_without_the_monitor_s_token_tares_nothing() {
    let line = Line::new();
    let (page, _monitor) = running(&line);
    assert_eq!(page.post("/board/tare", r#"{"force":true}"#).status, 401);
    assert!(line.board().done.iter().all(|command| *command == Command::Ping));
}

#[test]
fn a_monitor_is_announced_while_it_runs_to_its_user_alone() {
    let line = Line::new();
    let (page, _monitor) = running(&line);
    let folder = page.runtime_folder;
    assert!(RunningMonitor::find(folder.path(), "line 2").is_none(), "it has another line");
    #[cfg(unix)]
    for file in folder.path().read_dir().expect("a folder") {
        let metadata = file.and_then(|file| file.metadata()).expect("a file");
        assert_eq!(std::os::unix::fs::PermissionsExt::mode(&metadata.permissions()) & 0o777, 0o600);
    }
    drop(page.monitor);
    assert!(RunningMonitor::find(folder.path(), "line 1").is_none());
    assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);
}
