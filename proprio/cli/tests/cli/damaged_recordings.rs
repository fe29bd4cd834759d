//! Recordings that are damaged: a flipped bit loses its chunk alone, and the loss is named.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde_json::Value;

use super::board::SyntheticBoard;
use super::common::{Folder, arm, error_of, json, sweep, table};
use super::recording_files::{record, recorded, ticks};

fn flipped(recording: &[u8], at: usize, bit: u32) -> Vec<u8> {
    let mut damaged = recording.to_vec();
    damaged[at] ^= 1 << (bit % 8);
    damaged
}

#[test]
fn a_flipped_bit_loses_no_more_than_a_second_and_the_hole_is_named() {
    let recording = record(ticks(SyntheticBoard::new(1, 20.0)));
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut losses = 0;
    for _ in 0..24 {
        let at = 8 + random.next_u32() as usize % (recording.len() - 8);
        let folder = Folder::with("damaged.mcap", flipped(&recording, at, random.next_u32()));
        let run = folder.run(&["recover", "damaged.mcap", "-o", "whole.mcap"]);
        assert!(!run.stderr.contains("cut"), "byte {at}: {}", run.stderr);
        let is_loss = run.stderr.contains("is damaged and left out");
        assert_eq!(run.code, Some(is_loss.into()), "byte {at}: {}", run.stderr);
        losses += u32::from(is_loss);
        assert_eq!(is_loss, run.stderr.contains("% of its messages are kept"), "byte {at}: {}", run.stderr);
        for name in ["whole.mcap", "damaged.mcap"] {
            let run = folder.done(&["replay", name, "--table", table(), "--json"]);
            let session = &json(&run)["sessions"][0];
            let samples = session["samples"].as_u64().expect("a count");
            assert!(samples >= 1900, "{name}, byte {at}: {samples}");
            assert_eq!(session["recorded"]["first_difference"], Value::Null, "{name}, byte {at}: {}", run.stderr);
            let is_named =
                run.stderr.contains("s is damaged and left out") || run.stderr.contains("the end is damaged");
            assert_eq!(is_named, is_loss && name == "damaged.mcap", "{name}, byte {at}: {}", run.stderr);
        }
    }
    assert!(losses > 10, "most of a recording is chunks: {losses} losses");
}

#[test]
fn a_loss_is_told_with_its_times_and_share() {
    let recording = record(ticks(SyntheticBoard::new(1, 20.0)));
    let folder = Folder::with("damaged.mcap", flipped(&recording, recording.len() / 2, 4));
    let run = folder.run(&["recover", "damaged.mcap", "-o", "whole.mcap"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    let warning = run.stderr.lines().next().expect("a warning");
    let (from, to) = warning.split_once(" s to ").expect("two times");
    let from: f64 = from.rsplit(' ').next().expect("a time").parse().expect("a number");
    let to: f64 = to.split(' ').next().expect("a time").parse().expect("a number");
    assert!((9.0..11.0).contains(&from) && to > from + 0.5 && to < from + 1.1, "{warning}");
    let (recorded, stderr) = recorded(&folder, "damaged.mcap");
    assert!(recorded["not_compared"].as_u64().expect("a count") > 800, "{stderr}");
    assert!(stderr.contains("samples cannot be compared with the board"), "{stderr}");
}

#[test]
fn a_hole_is_named_wherever_the_recording_is_read() {
    let recording = record(ticks(SyntheticBoard::new(1, 20.0)));
    let folder = Folder::with("damaged.mcap", flipped(&recording, recording.len() / 2, 4));
    let page = ["report", "damaged.mcap", "--table", table(), "-o", "report.html"];
    for command in
        [&["check", "damaged.mcap", "--table", table()][..], &["replay", "damaged.mcap", "--table", table()], &page]
    {
        let run = folder.run(command);
        let named = run.stderr.lines().filter(|line| line.contains("s is damaged and left out")).count();
        assert_eq!(named, 1, "{command:?}: {}", run.stderr);
    }
}

#[test]
fn a_hole_in_a_recording_with_truth_is_named_by_calibrate_and_tune() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    folder.done(&["convert", "sweep.csv", "sweep.mcap"]);
    let whole = std::fs::read(folder.path("sweep.mcap")).expect("it was written");
    // In a message; the index of a chunk is between chunks, and its damage is harmless.
    let message =
        whole[whole.len() / 2..].windows(8).position(|bytes| bytes == b"arm_base").expect("messages have a frame");
    folder.write("sweep.mcap", flipped(&whole, whole.len() / 2 + message, 4));
    let calibrate = ["calibrate", "sweep.mcap", "--arm", arm(), "-o", "table.toml"];
    let tune = ["tune", "sweep.mcap", "--table", "table.toml", "-o", "tuned.toml"];
    for command in [calibrate, tune] {
        let run = folder.done(&command);
        let named = run.stderr.lines().filter(|line| line.contains("s is damaged and left out")).count();
        assert_eq!(named, 1, "{command:?}: {}", run.stderr);
        assert!(run.stderr.contains("warning: sweep.mcap: "), "{command:?}: {}", run.stderr);
    }
}

#[test]
fn damaged_first_bytes_are_those_of_a_recording() {
    let recording = record(ticks(SyntheticBoard::new(1, 5.0)));
    for at in 0..8 {
        let folder = Folder::with("damaged.mcap", flipped(&recording, at, 3));
        let error = folder.refused(&["replay", "damaged.mcap", "--table", table()]);
        assert!(error.contains("the recording is damaged: its first bytes"), "byte {at}: {error}");
        let run = folder.run(&["replay", "damaged.mcap", "--table", table()]);
        assert!(run.stderr.contains("`proprio recover`"), "byte {at}: {}", run.stderr);
        // Its data is whole.
        folder.done(&["recover", "damaged.mcap", "-o", "whole.mcap"]);
        folder.done(&["replay", "whole.mcap", "--table", table()]);
    }
}

#[test]
fn a_long_line_is_refused_by_its_number() {
    let text = format!("time_s,imu1_deg\n0,1\n{}", ",".repeat(3 << 20));
    let folder = Folder::with("session.csv", text);
    let run = folder.run(&["convert", "session.csv", "session.mcap"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    let error = error_of(&run.stderr);
    assert!(error.contains("session.csv, line 3: the line is longer than 1024 kB"), "{error}");
}

#[test]
fn a_foreign_file_is_refused_with_its_topics() {
    let folder = Folder::new();
    let file = std::fs::File::create(folder.path("foreign.mcap")).expect("a temporary folder can be written to");
    let mut writer = mcap::WriteOptions::new().compression(None).create(file).expect("it can be written");
    let id = writer.add_channel(0, "/tf", "json", &std::collections::BTreeMap::new()).expect("it can be written");
    let header = mcap::records::MessageHeader { channel_id: id, sequence: 0, log_time: 1, publish_time: 1 };
    writer.write_to_known_channel(&header, b"{}").expect("it can be written");
    writer.finish().expect("it can be written");
    let error = folder.refused(&["replay", "foreign.mcap", "--table", table()]);
    assert!(error.contains("/proprio/raw and /proprio/samples are missing, it has /tf"), "{error}");
}

#[test]
fn commands_warn_of_a_recording_that_lacks_the_samples_since_the_tare() {
    let mut session = sweep();
    session.rows.truncate(1500);
    let folder = Folder::with("sweep.csv", session.to_string());
    folder.done(&["convert", "sweep.csv", "sweep.mcap"]);
    let recording = std::fs::read(folder.path("sweep.mcap")).expect("it was written");
    // In the first chunk, which has the first second.
    folder.write("late.mcap", flipped(&recording, 3000, 2));
    let warning = "warning: late.mcap: samples since the board's last tare are not in the recording, so that ";
    let commands: [&[&str]; 3] = [
        &["calibrate", "late.mcap", "--arm", arm(), "-o", "table.toml"],
        &["check", "late.mcap", "--table", table()],
        &["tune", "late.mcap", "--table", table(), "-o", "tuned.toml"],
    ];
    for command in commands {
        let run = folder.run(command);
        assert!(run.stderr.contains(warning), "{command:?}: {}", run.stderr);
    }
    let run = folder.run(&["check", "sweep.mcap", "--table", table()]);
    assert!(!run.stderr.contains("last tare"), "{}", run.stderr);
    let run = folder.done(&["convert", "late.mcap", "late.csv"]);
    assert!(run.stderr.contains("have another tare or drift here than on the board"), "{}", run.stderr);
}
