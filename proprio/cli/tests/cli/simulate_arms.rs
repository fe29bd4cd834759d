//! `simulate --arm`: sessions of arms of other lengths, and with other sensors, than the reference arm.

use std::fmt::Write as _;

use super::common::{Csv, Folder, arm, figure, json, simulate};

/// A description of an arm with these segments: lengths of curve and connector, mm.
fn description(segments: &[(f64, f64)]) -> String {
    let mut text = "format = 1\narm = \"other\"\nrate_hz = 10.0\n".to_owned();
    for (index, (length_mm, offset_mm)) in segments.iter().enumerate() {
        let side = if index.is_multiple_of(2) { "end" } else { "start" };
        writeln!(text, "[[segment]]\nlength_mm = {length_mm}\noffset_mm = {offset_mm}\noffset_at = \"{side}\"")
            .expect("text can be written");
    }
    text
}

/// An arm of three unlike segments, 340 mm long, each with one bend sensor.
fn three() -> String {
    let mut text = description(&[(120.0, 30.0), (100.0, 20.0), (60.0, 10.0)]);
    for k in 0..3 {
        writeln!(text, "[[board.segment]]\nbend = [\"A{k}\"]\nimu = {{ channel = {k}, address = 0x28 }}")
            .expect("text can be written");
    }
    text
}

/// An arm of eight segments, 560 mm long.
fn eight() -> String {
    description(&[(60.0, 10.0); 8])
}

/// A session of an arm.
fn session(folder: &Folder, args: &str, output: &str) -> Csv {
    let args: Vec<&str> = args.split(' ').collect();
    folder.done(&[&["simulate", "--arm", "arm.toml", "-o", output][..], &args].concat());
    folder.csv(output)
}

/// Tip errors by bend sensors and by fusion in % of the arm's length, with a table that was calibrated on a sweep.
fn tip_errors_percent(description: &str, length_mm: f64) -> [f64; 2] {
    let folder = Folder::with("arm.toml", description);
    session(&folder, "--scenario sweep --seconds 600 --seed 1", "sweep.csv");
    session(&folder, "--scenario 1 --seconds 300 --seed 2", "session.csv");
    folder.done(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "table.toml"]);
    let report = json(&folder.done(&["replay", "session.csv", "--table", "table.toml", "--json"]));
    ["bend", "fusion"].map(|method| 100.0 * figure(&report, method, "tip_rmse_mm") / length_mm)
}

#[test]
fn the_reference_arms_description_gives_the_bytes_of_the_reference_arm() {
    let folder = Folder::new();
    let args = "--scenario 2 --seconds 20 --seed 81";
    let args: Vec<&str> = args.split(' ').collect();
    folder.done(&[&["simulate", "--arm", arm(), "-o", "session.csv"][..], &args].concat());
    assert!(folder.csv("session.csv") == simulate(&args.join(" ")));
}

#[test]
fn a_session_has_the_columns_of_the_arms_sensors() {
    let folder = Folder::with("arm.toml", three());
    let names = session(&folder, "--scenario 1 --seconds 1 --seed 82", "session.csv").names;
    let readings = ["time_s", "bend1a_adc", "bend2a_adc", "bend3a_adc", "imu1_deg", "imu2_deg", "imu3_deg"];
    let truth = (1..=3).flat_map(|i| ["x_mm", "y_mm", "heading_deg"].map(|name| format!("truth{i}_{name}")));
    assert_eq!(names, readings.map(str::to_owned).into_iter().chain(truth).collect::<Vec<_>>());
}

#[test]
fn a_segment_without_imu_has_an_empty_column_and_the_sweep_is_calibrated() {
    let folder = Folder::with("arm.toml", three().replace("imu = { channel = 1, address = 0x28 }", ""));
    let sweep = session(&folder, "--scenario sweep --seconds 120 --seed 82", "sweep.csv");
    let column = sweep.names.iter().position(|name| name == "imu2_deg").expect("the column");
    assert!(folder.read("sweep.csv").lines().skip(1).all(|row| row.split(',').nth(column) == Some("")));
    folder.done(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "table.toml"]);
}

#[test]
fn without_board_section_every_segment_has_two_bend_sensors() {
    let folder = Folder::with("arm.toml", eight());
    let session = session(&folder, "--scenario 1 --seconds 1 --seed 83", "session.csv");
    assert_eq!(session.names.iter().filter(|name| name.starts_with("bend")).count(), 16);
    assert!(session.has("bend8b_adc") && session.has("imu8_deg") && session.has("truth8_heading_deg"));
}

#[test]
fn the_straight_arm_has_the_lengths_of_its_file() {
    let folder = Folder::with("arm.toml", three());
    let session = session(&folder, "--scenario 1 --seconds 1 --seed 84", "session.csv");
    for (name, length_mm) in [("truth1_y_mm", 150.0), ("truth2_y_mm", 270.0), ("truth3_y_mm", 340.0)] {
        assert!((session.numbers(name)[0] - length_mm).abs() < 1e-3, "{name}");
    }
}

/// Single strips of the reference arm err by 5°, which over levers of 265, 130 and 35 mm are 26 mm, 8 % of the length.
#[test]
fn an_arm_of_three_segments_with_one_bend_sensor_each_calibrates_and_replays() {
    let [bend, fusion] = tip_errors_percent(&three(), 340.0);
    assert!((3.0..10.0).contains(&bend) && (0.1..6.0).contains(&fusion), "bend {bend} %, fusion {fusion} %");
}

/// Two strips a segment leave 1.4° of error, as on the reference arm, whose tip error of fusion is below one percent.
#[test]
fn an_arm_of_eight_segments_calibrates_and_replays() {
    let [bend, fusion] = tip_errors_percent(&eight(), 560.0);
    assert!((1.0..6.0).contains(&bend) && (0.1..2.0).contains(&fusion), "bend {bend} %, fusion {fusion} %");
}

#[test]
fn a_camera_sees_as_many_markers_as_the_arm_has_segments() {
    let folder = Folder::with("arm.toml", three());
    session(&folder, "--scenario 1 --seconds 2 --seed 85 --camera camera.csv", "session.csv");
    assert_eq!(folder.csv("camera.csv").names.len(), 4 + 3 * 3);
}

#[test]
fn arms_that_cannot_be_simulated_are_refused() {
    let folder = Folder::with("arm.toml", description(&[(60.0, 10.0); 9]));
    folder.write("broken.toml", "format = 1\n");
    let refused = |file: &str| {
        let args = ["simulate", "--scenario", "1", "--seconds", "1", "--seed", "1", "-o", "session.csv", "--arm", file];
        folder.refused(&args)
    };
    assert_eq!(refused("arm.toml"), "arm.toml: 9 segments, expected 1 to 8");
    assert!(refused("broken.toml").starts_with("broken.toml:"));
    assert!(refused("none.toml").starts_with("none.toml:"));
}
