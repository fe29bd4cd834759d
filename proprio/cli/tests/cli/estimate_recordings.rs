//! Estimates of a replay on the channels of a recording: `replay --out EST.mcap`, `convert --table`.

use std::collections::BTreeMap;

use super::board::SyntheticBoard;
use super::common::{Folder, json, quaternion_session, session, table};
use super::recording_files::{record, ticks};

/// Payloads of the messages on each channel, and the names of the attachments.
fn channels(folder: &Folder, name: &str) -> (BTreeMap<String, Vec<Vec<u8>>>, Vec<String>) {
    let bytes = std::fs::read(folder.path(name)).expect("it was written");
    let mut channels: BTreeMap<String, Vec<Vec<u8>>> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).expect("an MCAP file") {
        let message = message.expect("it is whole");
        channels.entry(message.channel.topic.clone()).or_default().push(message.data.to_vec());
    }
    let summary = mcap::Summary::read(&bytes).expect("an index").expect("an index");
    (channels, summary.attachment_indexes.into_iter().map(|index| index.name).collect())
}

/// The numbers of a `sensor_msgs/msg/JointState` of six segments, deg: the last six floats before two empty lists.
fn thetas_deg(message: &[u8]) -> Vec<f64> {
    let end = message.len() - 8;
    let floats = message[end - 48..end].chunks(8);
    floats.map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")).to_degrees()).collect()
}

#[test]
fn a_recording_of_a_replay_has_the_estimates_of_its_csv() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.done(&["replay", "session.csv", "--table", table(), "--out", "est.csv"]);
    let run = folder.done(&["replay", "session.csv", "--table", table(), "--out", "est.mcap"]);
    assert!(run.stdout.contains("fusion") && run.stderr.contains("est.mcap: "), "{}{}", run.stdout, run.stderr);
    let (channels, attachments) = channels(&folder, "est.mcap");
    for topic in ["/proprio/samples", "/joint_states", "/proprio/shape", "/proprio/uncertainty", "/proprio/truth"] {
        assert_eq!(channels[topic].len(), 150, "{topic}");
    }
    assert_eq!(attachments, ["table.toml"]);
    let estimates = folder.csv("est.csv");
    let expected: Vec<Vec<f64>> = (1..=6).map(|i| estimates.numbers(&format!("fusion{i}_theta_deg"))).collect();
    let is_same = |a: f64, b: f64| a.is_nan() && b.is_nan() || (a - b).abs() < 1e-6;
    for (row, message) in channels["/joint_states"].iter().enumerate() {
        let found = thetas_deg(message);
        assert!(found.iter().zip(&expected).all(|(found, column)| is_same(*found, column[row])), "{row}: {found:?}");
    }
}

#[test]
fn a_csv_becomes_a_recording_with_the_estimates_of_a_table() {
    let folder = Folder::with("session.csv", quaternion_session().to_string());
    folder.done(&["convert", "session.csv", "plain.mcap"]);
    let run = folder.done(&["convert", "session.csv", "full.mcap", "--table", table()]);
    assert!(run.stderr.contains("no times of arrival"), "{}", run.stderr);
    let ((plain, _), (full, _)) = (channels(&folder, "plain.mcap"), channels(&folder, "full.mcap"));
    assert!(!plain.contains_key("/joint_states"));
    assert_eq!(full["/joint_states"].len(), 150);
    // The session in it is the same.
    for topic in ["/proprio/raw", "/proprio/samples", "/proprio/truth"] {
        assert!(plain[topic] == full[topic], "{topic}");
    }
    let errors = |name: &str| json(&folder.done(&["replay", name, "--table", table(), "--json"]))["all"].clone();
    assert_eq!(errors("full.mcap"), errors("session.csv"));
}

#[test]
fn estimates_of_a_recording_are_those_of_its_board_at_the_same_times() {
    let bytes = record(ticks(SyntheticBoard::new(1, 20.0)));
    let folder = Folder::with("session.mcap", bytes);
    folder.done(&["replay", "session.mcap", "--table", table(), "--out", "est.mcap"]);
    let [(board, _), (replay, _)] = ["session.mcap", "est.mcap"].map(|name| channels(&folder, name));
    for topic in ["/joint_states", "/proprio/shape", "/proprio/samples"] {
        assert!(board[topic] == replay[topic], "{topic}");
    }
    assert!(replay["/proprio/uncertainty"].len() > board["/proprio/uncertainty"].len());
}

#[test]
fn estimates_that_no_channel_has_are_refused() {
    let folder = Folder::with("session.csv", session().to_string());
    for option in ["--smooth", "--float"] {
        let error = folder.refused(&["replay", "session.csv", "--table", table(), "--out", "est.mcap", option]);
        assert_eq!(error, format!("est.mcap: a recording has no channel for the estimates of {option}"));
    }
}

#[test]
fn a_conversion_adds_estimates_to_the_recording_of_a_csv_alone() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.done(&["convert", "session.csv", "session.mcap"]);
    for (from, to) in [("session.csv", "session.bin"), ("session.mcap", "other.csv")] {
        let error = folder.refused(&["convert", from, to, "--table", table()]);
        assert!(error.ends_with(&format!("found {from} to {to}")), "{error}");
    }
}
