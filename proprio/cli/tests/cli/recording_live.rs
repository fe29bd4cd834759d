//! `proprio record` from a port: a pseudo-terminal whose other end is a synthetic board.

use std::io::{Read, Write};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serialport::{SerialPort, TTYPort};

use super::board::SyntheticBoard;
use super::common::{Folder, error_of, table};
use super::recording_files::recorded;

/// Starts the recorder on a pseudo-terminal and plays the board's stream, four times as fast as a board, until `done`.
fn play(folder: &Folder, seconds: f64, done: impl FnOnce(&mut Child)) -> String {
    play_from(folder, 0, seconds, done)
}

/// The same of a board that has run for some ticks before.
fn play_from(folder: &Folder, tick: usize, seconds: f64, done: impl FnOnce(&mut Child)) -> String {
    let (mut board, port) = TTYPort::pair().expect("the system has pseudo-terminals");
    let name = port.name().expect("it has a name");
    drop(port);
    let mut command = folder.command(&["record", "--port", &name, "-o", "a.mcap", "--table", table()]);
    let mut child = command.stderr(Stdio::piped()).spawn().expect("the tool starts");
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            // The tool has the port open when its greeting comes.
            let mut greeting = [0; 64];
            while !stop.load(Ordering::Relaxed) && board.read(&mut greeting).is_err() {
                std::thread::sleep(Duration::from_millis(5));
            }
            for (frames, _) in SyntheticBoard::new(1, seconds).skip(tick) {
                if stop.load(Ordering::Relaxed) || board.write_all(&frames.concat()).is_err() {
                    return;
                }
                let waiting = board.bytes_to_read().unwrap_or(0);
                if waiting > 0 {
                    let _ = board.read(&mut greeting);
                }
                std::thread::sleep(Duration::from_micros(2500));
            }
            while !stop.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        done(&mut child);
        stop.store(true, Ordering::Relaxed);
    });
    let mut messages = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut messages).expect("the tool writes UTF-8");
    child.wait().expect("it has ended");
    messages
}

/// Waits until the recording has so many bytes.
fn wait_for_bytes(folder: &Folder, bytes: u64) {
    let end = Instant::now() + Duration::from_mins(1);
    let length = || std::fs::metadata(folder.path("a.mcap")).map_or(0, |file| file.len());
    while length() < bytes {
        assert!(Instant::now() < end, "{} of {bytes} bytes", length());
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_recording_that_is_killed_is_recovered_and_replays_bit_for_bit() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..3 {
        let folder = Folder::new();
        let bytes = 300_000 + u64::from(random.next_u32() % 700_000);
        play(&folder, 60.0, |child| {
            wait_for_bytes(&folder, bytes);
            child.kill().expect("it runs");
        });
        // The end is lost.
        assert_eq!(folder.run(&["recover", "a.mcap", "-o", "whole.mcap"]).code, Some(1));
        let (recorded, stderr) = recorded(&folder, "whole.mcap");
        assert_eq!(
            (&recorded["equal"], &recorded["table_matches"]),
            (&recorded["estimates"], &true.into()),
            "{stderr}"
        );
        assert!(recorded["equal"].as_u64().expect("a count") > 200, "{stderr}");
    }
}

/// Ends the recorder as Ctrl-C does, once it has recorded for a while.
fn interrupt(folder: &Folder, child: &mut Child) {
    wait_for_bytes(folder, 200_000);
    let id = child.id().to_string();
    let sent = std::process::Command::new("kill").args(["-INT", &id]).status().expect("kill starts");
    assert!(sent.success());
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

#[test]
fn an_interrupt_ends_a_recording_well() {
    let folder = Folder::new();
    let messages = play(&folder, 60.0, |child| interrupt(&folder, child));
    assert!(messages.starts_with("a.mcap: 0:00:") && messages.contains(" 0 frames lost, 0 damaged"), "{messages}");
    assert!(!messages.contains("warning"), "{messages}");
    let (recorded, stderr) = recorded(&folder, "a.mcap");
    assert_eq!(recorded["equal"], recorded["estimates"], "{stderr}");
}

#[test]
fn a_recording_of_a_board_that_was_not_restarted_says_that_it_cannot_be_compared() {
    let folder = Folder::new();
    let messages = play_from(&folder, 300, 60.0, |child| interrupt(&folder, child));
    assert!(messages.contains("warning: a.mcap: ") && messages.contains("a replay cannot compare"), "{messages}");
    let (recorded, stderr) = recorded(&folder, "a.mcap");
    assert_eq!((&recorded["equal"], &recorded["not_compared"]), (&0.into(), &recorded["estimates"]), "{stderr}");
    assert!(stderr.contains("none of the ") && !stderr.contains("bit for bit"), "{stderr}");
}

#[test]
fn a_recording_replaces_no_other() {
    let folder = Folder::with("a.mcap", "another recording");
    let (_board, port) = TTYPort::pair().expect("the system has pseudo-terminals");
    let name = port.name().expect("it has a name");
    drop(port);
    let error = folder.refused(&["record", "--port", &name, "-o", "a.mcap", "--seconds", "1"]);
    assert!(error.contains("is there already"), "{error}");
    assert_eq!(folder.read("a.mcap"), "another recording");
}

#[test]
fn a_recording_of_a_silent_board_ends_after_its_time_with_an_error_and_no_file() {
    let folder = Folder::new();
    let (_board, port) = TTYPort::pair().expect("the system has pseudo-terminals");
    let name = port.name().expect("it has a name");
    drop(port);
    let error = folder.refused(&["record", "--port", &name, "-o", "a.mcap", "--seconds", "1"]);
    assert!(error.contains(&format!("{name}: no Hello and Health within 1 s; 0 frames were read")), "{error}");
}

#[test]
fn a_silent_board_has_no_status() {
    let folder = Folder::new();
    let (_board, port) = TTYPort::pair().expect("the system has pseudo-terminals");
    let name = port.name().expect("it has a name");
    drop(port);
    let run = folder.run(&["status", "--port", &name]);
    let (notice, error) = run.stderr.split_once('\n').expect("a notice and an error");
    assert_eq!(notice, format!("{name}: waiting for a board's messages, 10 s at most"));
    assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""));
    assert!(error_of(error).contains("no Hello and Health within 10 s"), "{error}");
}
