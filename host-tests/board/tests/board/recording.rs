//! The tools as they are used: `proprio` records and monitors the firmware on the virtual Due over a pseudo-terminal, and
//! over pipes.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::tools::{Running, done, folder, proprio, replayed, table, tool};

/// Size of a recording of 20 s, bytes: at most 150 kB a second.
const LONG: u64 = 2_400_000;

/// The virtual Due with the firmware, and the path of its serial port.
fn virtual_due(folder: &Path) -> (Running, String) {
    let mut command = Command::new(tool("virtual-due"));
    command.current_dir(folder).args(["run", "firmware", "--speed", "real", "--serial", "pty"]);
    let mut child = command.stdin(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the emulator starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let first = lines.next().expect("it says its port").expect("it writes UTF-8");
    // It says more, which must not fill the pipe.
    std::thread::spawn(move || lines.for_each(drop));
    let port = first.strip_prefix("serial port: ").expect("the path of its port").to_owned();
    (Running(child), port)
}

#[test]
fn a_recording_of_the_firmware_that_is_killed_is_recovered_and_replays_bit_for_bit() {
    let folder = folder("killed");
    let (_due, port) = virtual_due(&folder);
    let child = proprio(&folder, &["record", "--port", &port, "-o", "cut.mcap", "--table", &table()]).spawn();
    let mut recorder = Running(child.expect("the tool starts"));
    let end = Instant::now() + Duration::from_mins(5);
    while fs::metadata(folder.join("cut.mcap")).map_or(0, |file| file.len()) < LONG {
        assert!(recorder.0.try_wait().expect("it can be asked").is_none(), "it has ended by itself");
        assert!(Instant::now() < end, "20 s take over five minutes");
        std::thread::sleep(Duration::from_millis(3));
    }
    // SIGKILL, at whatever byte it is.
    recorder.0.kill().expect("it runs");
    recorder.0.wait().expect("it ends");

    done(&folder, &["recover", "cut.mcap", "-o", "whole.mcap"]);
    let (equal, report) = replayed(&folder, "whole.mcap");
    assert!(equal > 1500, "{report}");
    assert!(report.contains("\"table_matches\":true"), "{report}");
}

#[test]
fn the_virtual_due_is_recorded_over_pipes() {
    let folder = folder("pipes");
    done(&folder, &["record", "--virtual", "--firmware", "firmware", "--seconds", "5", "-o", "a.mcap"]);
    let (equal, report) = replayed(&folder, "a.mcap");
    assert!(equal > 100, "{report}");
}

#[test]
fn status_says_how_the_virtual_due_is() {
    let folder = folder("status");
    let status = done(&folder, &["status", "--virtual", "--firmware", "firmware", "--table", &table()]);
    for line in ["arm           planar-6", "the one given", "bend sensors  12 of 12 ok", "IMUs          6 of 6 ok"] {
        assert!(status.contains(line), "{status}");
    }
    assert!(status.contains("virtual Due, answers") && status.contains(" 0 damaged, 0 lost"), "{status}");
}

#[test]
fn monitor_prints_a_line_a_second_for_a_terminal() {
    let folder = folder("plain");
    let mut command = proprio(&folder, &["monitor", "--plain", "--virtual", "--firmware", "firmware"]);
    let mut monitor = Running(command.stdout(Stdio::piped()).spawn().expect("the tool starts"));
    let lines = BufReader::new(monitor.0.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
    let line = lines.take(60).find(|line| line.starts_with("θ ")).expect("the board estimates within a minute");
    for part in ["°  tip ", " mm  ", " samples/s  0 lost  0 damaged  load "] {
        assert!(line.contains(part), "{line}");
    }
}
