//! The tools as users run them: `proprio` records and monitors the firmware on the virtual Due over a pseudo-terminal, and
//! over pipes.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use board_tests::due::DueProcess;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::tools::{Running, done, folder, proprio, replayed, table};

/// Size of a recording of 20 s, bytes: at most 150 kB a second.
const LONG: u64 = 2_400_000;

/// Records from a port until the file has `bytes` bytes, and for `wait` after that; then kills the recorder, at any byte.
fn record_and_kill(folder: &Path, port: &str, name: &str, bytes: u64, wait: Duration) {
    let child = proprio(folder, &["record", "--port", port, "-o", name, "--table", &table()]).spawn();
    let mut recorder = Running(child.expect("the tool starts"));
    let end = Instant::now() + Duration::from_mins(5);
    while fs::metadata(folder.join(name)).map_or(0, |file| file.len()) < bytes {
        assert!(recorder.0.try_wait().expect("its state is readable").is_none(), "the recorder has ended");
        assert!(Instant::now() < end, "20 s take over five minutes");
        std::thread::sleep(Duration::from_millis(3));
    }
    std::thread::sleep(wait);
    recorder.0.kill().expect("it runs");
    assert_eq!(recorder.0.wait().expect("it ends").code(), None, "the recorder had ended before");
}

/// Recovers a cut file and replays it; returns the number of estimates equal to the board's, bit for bit, and the report.
fn recovered(folder: &Path, name: &str) -> (u64, String) {
    let _ = fs::remove_file(folder.join("whole.mcap"));
    let output = proprio(folder, &["recover", name, "-o", "whole.mcap"]).output().expect("the tool starts");
    // The end is lost.
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    replayed(folder, "whole.mcap")
}

#[test]
fn a_recording_of_the_firmware_that_is_killed_or_cut_is_recovered_and_replays_bit_for_bit() {
    let folder = folder("killed");
    let due = DueProcess::start(&folder);
    record_and_kill(&folder, &due.port, "killed.mcap", LONG, Duration::ZERO);
    let (whole, report) = recovered(&folder, "killed.mcap");
    assert!(whole > 1500, "{report}");
    assert!(report.contains("\"table_matches\":true"), "{report}");

    let killed = fs::read(folder.join("killed.mcap")).expect("it is there");
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..16 {
        // After the first chunk of samples, which ends in the second second: a cut before its end leaves no sample.
        let cut = killed.len() / 8 + random.next_u32() as usize % (killed.len() * 7 / 8);
        fs::write(folder.join("cut.mcap"), &killed[..cut]).expect("there is room");
        let (saved, report) = recovered(&folder, "cut.mcap");
        // All but the last chunk, which is a second.
        let at_best = whole * cut as u64 / killed.len() as u64;
        assert!(saved + 200 > at_best, "cut at {cut} of {}: {saved} of about {at_best}: {report}", killed.len());
    }
}

#[test]
fn a_recorder_may_be_killed_at_any_moment() {
    let folder = folder("killed at random");
    let due = DueProcess::start(&folder);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    for name in ["a.mcap", "b.mcap", "c.mcap", "d.mcap"] {
        let bytes = 250_000 + u64::from(random.next_u32() % 350_000);
        let wait = Duration::from_millis(u64::from(random.next_u32() % 1000));
        record_and_kill(&folder, &due.port, name, bytes, wait);
        let (saved, report) = recovered(&folder, name);
        // 150 kB a second at most.
        assert!(saved + 200 > bytes / 1500, "{saved} of {bytes} bytes: {report}");
    }
}

#[test]
fn the_virtual_due_is_recorded_over_pipes() {
    let folder = folder("pipes");
    done(&folder, &["record", "--virtual", "--firmware", "firmware", "--seconds", "5", "-o", "a.mcap"]);
    let (equal, report) = replayed(&folder, "a.mcap");
    assert!(equal > 100, "{report}");
}

#[test]
fn status_shows_the_state_of_the_virtual_due() {
    let folder = folder("status");
    let status = done(&folder, &["status", "--virtual", "--firmware", "firmware", "--table", &table()]);
    for line in ["arm           planar-6", "the one given", "bend sensors  12 of 12 ok", "IMUs          6 of 6 ok"] {
        assert!(status.contains(line), "{status}");
    }
    assert!(status.contains("virtual Due, answers") && status.contains(" 0 damaged, 0 lost"), "{status}");
}

#[test]
fn a_flash_file_of_another_size_is_named_with_the_size_that_it_must_have() {
    let folder = folder("flash of another size");
    fs::write(folder.join("flash.bin"), [0; 1000]).expect("the folder is writable");
    let arguments = ["status", "--virtual", "--firmware", "firmware", "--flash", "flash.bin"];
    let run = proprio(&folder, &arguments).output().expect("the tool starts");
    let error = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(2), "{error}");
    assert!(error.contains("flash.bin") && error.contains("512 KiB") && !error.contains("pipe"), "{error}");
}

#[test]
fn status_is_json_for_programs() {
    let folder = folder("status as JSON");
    let printed = done(&folder, &["status", "--virtual", "--firmware", "firmware", "--table", &table(), "--json"]);
    let status: serde_json::Value = serde_json::from_str(&printed).expect("JSON and nothing else");
    let hello = &status["hello"];
    assert_eq!(
        (&hello["arm"], &hello["boot"], &status["proprio"]),
        (&"planar-6".into(), &1.into(), &hello["firmware"])
    );
    assert_eq!((&status["answers"], &status["table_matches"]), (&true.into(), &true.into()), "{printed}");
    assert_eq!(
        (&status["received"]["lost"], &status["health"]["imu"][5]["state"]),
        (&0.into(), &"Ok".into()),
        "{printed}"
    );
    let samples_hz = status["rates"]["samples_hz"].as_f64().expect("a number");
    assert!((90.0..110.0).contains(&samples_hz), "{samples_hz}");
}

#[test]
fn monitor_prints_a_line_a_second_for_a_terminal() {
    let folder = folder("plain");
    let mut command = proprio(&folder, &["monitor", "--plain", "--virtual", "--firmware", "firmware"]);
    let mut monitor = Running(command.stdout(Stdio::piped()).spawn().expect("the tool starts"));
    let lines = BufReader::new(monitor.0.stdout.take().expect("a pipe")).lines().map_while(Result::ok);
    // The first lines may be from before the first `Health`.
    let is_complete = |line: &String| line.starts_with("θ ") && line.contains(" load ");
    let line = lines.take(60).find(is_complete).expect("the board sends estimates and its health within a minute");
    for part in ["°  tip ", " mm  ", " samples/s  0 lost  0 damaged  load "] {
        assert!(line.contains(part), "{line}");
    }
}
