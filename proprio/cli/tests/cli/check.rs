//! `proprio check`: silent on a good session, and each fault is named with its sensor.

use std::sync::OnceLock;

use super::common::{Csv, Folder, json, simulate, table};

/// 60 s of free swings at 10 Hz.
fn session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 60 --seed 61")).clone()
}

/// Sensor and kind of each finding.
fn findings(session: &Csv) -> Vec<(String, String)> {
    let folder = Folder::with("session.csv", session.to_string());
    let run = folder.run(&["check", "session.csv", "--table", table(), "--json"]);
    let checked = json(&run);
    let list = checked[0]["findings"].as_array().expect("a list of findings");
    assert_eq!(run.code, Some(i32::from(!list.is_empty())), "{}", run.stderr);
    let text = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    list.iter().map(|finding| (text(&finding["sensor"]), text(&finding["kind"]))).collect()
}

#[track_caller]
fn assert_found(edit: impl FnOnce(&mut Csv), expected: &[(&str, &str)]) {
    let mut session = session();
    edit(&mut session);
    let expected: Vec<_> = expected.iter().map(|(sensor, kind)| ((*sensor).to_owned(), (*kind).to_owned())).collect();
    assert_eq!(findings(&session), expected);
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

/// Adds `turn` to a heading from a row on.
fn turned(row: usize, cell: &str, from: usize, turn: f64) -> String {
    if row < from { cell.to_owned() } else { format!("{:.4}", (number(cell) + turn).rem_euclid(360.0)) }
}

fn bend_names() -> impl Iterator<Item = String> {
    (1..=6).flat_map(|i| ["a", "b"].map(|place| format!("bend{i}{place}_adc")))
}

#[test]
fn a_good_session_is_clean() {
    let folder = Folder::with("session.csv", session().to_string());
    let run = folder.done(&["check", "session.csv", "--table", table()]);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
}

#[test]
fn a_line_names_sensor_rows_figure_and_remedy() {
    let mut session = session();
    session.map("imu4_deg", |row, cell| turned(row, cell, 300, 90.0));
    (295..300).for_each(|row| session.set(row, "imu4_deg", ""));
    let folder = Folder::with("session.csv", session.to_string());
    let run = folder.run(&["check", "session.csv", "--table", table()]);
    assert_eq!(run.code, Some(1));
    let start = "session.csv: imu4, row 301 (30.000 s): the heading continues ";
    assert!(run.stdout.starts_with(start) && run.stdout.contains("check the IMU's supply"), "{}", run.stdout);
    let run = folder.done(&["replay", "session.csv", "--table", table()]);
    assert!(run.stderr.contains("warning: session.csv: imu4, row 301"), "{}", run.stderr);
    folder.done(&["report", "session.csv", "--table", table(), "-o", "report.html"]);
    assert!(folder.read("report.html").contains("Findings of the session check"));
}

#[test]
fn counts_of_another_adc_are_found() {
    let tenth = |session: &mut Csv| {
        bend_names().for_each(|name| session.map(&name, |_, cell| format!("{}", (number(cell) / 4.0).floor())));
    };
    assert_found(tenth, &[("all bend sensors", "ten_bits")]);
    let mut session = session();
    bend_names().for_each(|name| session.map(&name, |_, cell| format!("{}", (number(cell) * 3.3 / 5.0).floor())));
    let found = findings(&session);
    assert_eq!(found.len(), 12, "{found:?}");
    assert!(found.iter().all(|(_, kind)| kind == "outside_map"), "{found:?}");
}

#[test]
fn a_shorted_strip_is_found() {
    let shorted = |session: &mut Csv| (200..400).for_each(|row| session.set(row, "bend2a_adc", "0"));
    assert_found(shorted, &[("bend2a", "rail")]);
}

#[test]
fn repeated_values_are_found() {
    let repeat = |name: &'static str, from: usize| {
        move |session: &mut Csv| {
            let value = session.cell(from, name).to_owned();
            session.map(name, |row, cell| if row < from { cell.to_owned() } else { value.clone() });
        }
    };
    assert_found(repeat("imu4_deg", 250), &[("imu4", "frozen")]);
    assert_found(repeat("bend3b_adc", 250), &[("bend3b", "frozen")]);
    assert_found(repeat("bend3b_adc", 0), &[("bend3b", "constant")]);
}

#[test]
fn failed_readings_of_zero_are_found() {
    let zeros = |session: &mut Csv| (150..600).step_by(100).for_each(|row| session.set(row, "imu5_deg", "0.0000"));
    let mut session = session();
    zeros(&mut session);
    assert_eq!(findings(&session), [("imu5".to_owned(), "zeros".to_owned())]);
}

#[test]
fn imus_of_one_channel_are_found() {
    let copy = |session: &mut Csv| {
        let other: Vec<String> = session.rows.iter().map(|row| row[session.column("imu3_deg")].clone()).collect();
        session.map("imu4_deg", |row, _| other[row].clone());
    };
    assert_found(copy, &[("imu3 and imu4", "same_readings")]);
}

#[test]
fn exchanged_plugs_are_found() {
    assert_found(|session| session.swap("imu2_deg", "imu5_deg"), &[("imu2 and imu5", "exchanged")]);
    let bends = |session: &mut Csv| {
        session.swap("bend2a_adc", "bend5a_adc");
        session.swap("bend2b_adc", "bend5b_adc");
    };
    assert_found(bends, &[("bend2 and bend5", "exchanged")]);
}

#[test]
fn headings_in_another_direction_or_unit_are_found() {
    let negative = |cell: &str| format!("{:.4}", (-number(cell)).rem_euclid(360.0));
    assert_found(|session| session.map("imu3_deg", |_, cell| negative(cell)), &[("imu3", "inverted")]);
    let all = |session: &mut Csv| (1..=6).for_each(|i| session.map(&format!("imu{i}_deg"), |_, cell| negative(cell)));
    assert_found(all, &[("all IMUs", "inverted")]);
    let radians = |session: &mut Csv| {
        (1..=6).for_each(|i| {
            session.map(&format!("imu{i}_deg"), |_, cell| format!("{:.4}", number(cell).to_radians()));
        });
    };
    assert_found(radians, &[("all IMUs", "radians")]);
}

#[test]
fn quaternions_in_another_order_are_found() {
    let mut session = simulate("--scenario 1 --seconds 60 --seed 61 --imu quaternion");
    for i in 1..=6 {
        for (from, to) in [("qw", "last"), ("qx", "qw"), ("qy", "qx"), ("qz", "qy"), ("last", "qz")] {
            session.rename(&format!("imu{i}_{from}"), &format!("imu{i}_{to}"));
        }
    }
    assert_eq!(findings(&session), [("all IMUs".to_owned(), "unrelated".to_owned())]);
}

#[test]
fn a_tare_that_is_bent_or_moves_is_found() {
    let kinds = |motion: &str| {
        let session = simulate(&format!("--scenario 1 --motion {motion} --seconds 30 --seed 5"));
        findings(&session).into_iter().map(|(sensor, kind)| format!("{sensor} {kind}")).collect::<Vec<_>>()
    };
    assert_eq!(kinds("bent-start"), ["arm tare_bent"]);
    assert!(kinds("moving-start").contains(&"arm tare_moves".to_owned()));
}

#[test]
fn times_in_another_unit_are_found() {
    let times =
        |factor: f64| move |session: &mut Csv| session.map("time_s", |_, cell| format!("{:.6}", number(cell) * factor));
    assert_found(times(1000.0), &[("time_s", "time_unit")]);
    assert_found(times(1.0 / 60.0), &[("time_s", "time_unit")]);
}

#[test]
fn equal_times_and_gaps_are_found() {
    let whole = |session: &mut Csv| session.map("time_s", |_, cell| format!("{:.0}", number(cell).floor()));
    assert_found(whole, &[("time_s", "equal_times")]);
    assert_found(|session| drop(session.rows.drain(300..330)), &[("time_s", "gaps")]);
}

#[test]
fn a_bend_sensor_that_comes_loose_is_found() {
    let loose = |session: &mut Csv| {
        let shifted = |cell: &str| format!("{}", number(cell) + 250.0);
        session.map("bend3a_adc", |row, cell| if row < 200 { cell.to_owned() } else { shifted(cell) });
    };
    let mut session = session();
    loose(&mut session);
    let found = findings(&session);
    assert!(!found.is_empty() && found.iter().all(|(sensor, _)| sensor == "bend3a"), "{found:?}");
}
