//! Every command that reads sessions makes the same of a recording as of the CSV.

use super::common::{Csv, Folder, arm, quaternion_session, simulate, table};
use super::recordings::{Recording, args};
use super::tune::spoiled;

/// The session as CSV and as a recording, each named `session`, in folders of their own: names stand in what is written.
fn both(csv: &Csv) -> [Folder; 2] {
    let folder = Folder::with("a.csv", csv.to_string());
    folder.done(&["convert", "a.csv", "a.mcap"]);
    ["a.csv", "a.mcap"].map(|name| Folder::with("session", std::fs::read(folder.path(name)).expect("it was written")))
}

fn assert_same(folders: &[Folder; 2], command: &[&str], output: &str) {
    let [csv, recording] = folders.each_ref().map(|folder| {
        folder.done(command);
        folder.read(output)
    });
    assert!(csv == recording, "{output} of {command:?}");
}

#[test]
fn calibrate_makes_the_same_table() {
    let sweep = simulate("--scenario sweep --seconds 600 --seed 41 --imu quaternion");
    assert_same(&both(&sweep), &["calibrate", "session", "--arm", arm(), "-o", "table.toml"], "table.toml");
}

#[test]
fn tune_makes_the_same_table() {
    let folders = both(&simulate("--scenario 1 --seconds 60 --seed 52 --imu quaternion"));
    for folder in &folders {
        folder.write("table.toml", spoiled());
    }
    assert_same(&folders, &["tune", "session", "--table", "table.toml", "-o", "tuned.toml"], "tuned.toml");
}

#[test]
fn report_draws_the_same_page() {
    let folders = both(&quaternion_session());
    assert_same(&folders, &["report", "session", "--table", table(), "-o", "report.html"], "report.html");
}

#[test]
fn truth_without_headings_stays_so_in_a_recording() {
    let mut session = quaternion_session();
    (1..=6).for_each(|i| session.remove(&format!("truth{i}_heading")));
    let folders = both(&session);
    let replays = folders.each_ref().map(|folder| folder.done(&["replay", "session", "--table", table()]).stdout);
    assert_eq!(replays[0], replays[1]);
    let [_, recording] = &folders;
    recording.done(&["convert", "session", "b.csv"]);
    let back = recording.csv("b.csv");
    assert!(back.has("truth6_x_m") && !back.has("truth6_heading_rad"));
    let error = recording.refused(&["calibrate", "session", "--arm", arm(), "-o", "table.toml"]);
    assert!(error.starts_with("session: has no truth in its first samples"), "{error}");
}

/// The recording holds the same samples; its headings are those of quaternions.
#[test]
fn align_makes_of_a_recording_what_it_makes_of_its_csv() {
    let Recording { session, camera } = Recording::simulate("--scenario 1 --seconds 300 --seed 71 --imu quaternion");
    let folder = Folder::with("a.csv", session.to_string());
    folder.write("camera.csv", camera.to_string());
    folder.done(&["convert", "a.csv", "session.csv.mcap"]);
    folder.done(&["convert", "session.csv.mcap", "session.csv"]);
    let of_csv = folder.done(&args(arm())).stdout;
    let expected = folder.read("aligned.csv");
    std::fs::rename(folder.path("session.csv.mcap"), folder.path("session.csv")).expect("both are in one folder");
    let of_recording = folder.done(&[&args(arm())[..], &["--force"]].concat()).stdout;
    assert_eq!(of_csv, of_recording);
    assert!(folder.read("aligned.csv") == expected, "the aligned sessions differ");
}
