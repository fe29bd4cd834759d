//! `proprio check` on faults of a part of the session: plugs put back wrongly, hung loggers, restarts of all IMUs.

use std::sync::OnceLock;

use super::common::{Csv, Folder, json, simulate, table};

/// 200 s of free swings at 10 Hz, of which the arm rests for 5 s.
fn session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 200 --seed 62")).clone()
}

/// A finding: sensor and kind, first row, last row, figure, text with remedy.
#[derive(Debug)]
struct Found {
    name: String,
    rows: [u64; 2],
    figure: f64,
    text: String,
}

fn findings(session: &Csv) -> Vec<Found> {
    let folder = Folder::with("session.csv", session.to_string());
    let checked = json(&folder.run(&["check", "session.csv", "--table", table(), "--json"]));
    let found = |finding: &serde_json::Value| {
        let text = |key: &str| finding[key].as_str().expect("a text").to_owned();
        Found {
            name: format!("{} {}", text("sensor"), text("kind")),
            rows: ["first", "last"].map(|key| finding["rows"][key].as_u64().expect("a row")),
            figure: finding["figure"].as_f64().expect("a figure"),
            text: format!("{}; {}", text("text"), text("help")),
        }
    };
    checked[0]["findings"].as_array().expect("a list of findings").iter().map(found).collect()
}

/// The only finding of the session after `edit`.
#[track_caller]
fn found(edit: impl FnOnce(&mut Csv), name: &str) -> Found {
    let mut session = session();
    edit(&mut session);
    let mut findings = findings(&session);
    assert_eq!(findings.len(), 1, "{findings:?}");
    let found = findings.remove(0);
    assert_eq!(found.name, name, "{}", found.text);
    found
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

fn imus() -> Vec<String> {
    (1..=6).map(|i| format!("imu{i}_deg")).collect()
}

fn sensors() -> Vec<String> {
    let bends = (1..=6).flat_map(|i| ["a", "b"].map(|place| format!("bend{i}{place}_adc")));
    bends.chain(imus()).collect()
}

/// Exchanges two columns from a row on.
fn exchange(session: &mut Csv, one: &str, other: &str, rows: std::ops::Range<usize>) {
    let (one, other) = (session.column(one), session.column(other));
    session.rows[rows].iter_mut().for_each(|row| row.swap(one, other));
}

/// Repeats the cells of a row in the `count` rows after it.
fn hold(session: &mut Csv, names: &[String], from: usize, count: usize) {
    for name in names {
        let cell = session.cell(from, name).to_owned();
        (from + 1..=from + count).for_each(|row| session.set(row, name, &cell));
    }
}

/// Adds `turn` to the headings from a row on, after seven rows without readings.
fn restart(session: &mut Csv, names: &[String], from: usize, turn: f64) {
    for name in names {
        session.map(name, |row, cell| match row {
            _ if row >= from => format!("{:.4}", (number(cell) + turn).rem_euclid(360.0)),
            _ if row + 7 >= from => String::new(),
            _ => cell.to_owned(),
        });
    }
}

#[test]
fn plugs_that_are_exchanged_for_a_part_of_the_session_are_found() {
    let later = found(|session| exchange(session, "imu3_deg", "imu4_deg", 1000..2000), "imu3 and imu4 exchanged");
    // The begin is known to a piece of 25 s, before or after.
    assert!((750..=1251).contains(&later.rows[0]) && later.rows[1] == 2000, "{later:?}");
    assert!(later.figure > 90.0, "{later:?}");
    let earlier = found(|session| exchange(session, "imu1_deg", "imu6_deg", 0..900), "imu1 and imu6 exchanged");
    assert!(earlier.rows[0] == 1 && (650..=1150).contains(&earlier.rows[1]), "{earlier:?}");
    let bends = |session: &mut Csv| {
        exchange(session, "bend2a_adc", "bend5a_adc", 1000..2000);
        exchange(session, "bend2b_adc", "bend5b_adc", 1000..2000);
    };
    let bends = found(bends, "bend2 and bend5 exchanged");
    assert!((750..=1251).contains(&bends.rows[0]), "{bends:?}");
}

/// Two seconds of motion are too short to tell an exchange from two restarts.
#[test]
fn opposite_jumps_of_two_imus_are_named_with_both_causes() {
    let mut session = session();
    session.rows.truncate(500);
    exchange(&mut session, "imu3_deg", "imu4_deg", 480..500);
    let findings = findings(&session);
    assert_eq!(findings.len(), 1, "{findings:?}");
    let found = &findings[0];
    assert_eq!((found.name.as_str(), found.rows[0]), ("imu3 and imu4 new_zero", 481));
    assert!(found.text.contains("the plugs were exchanged, or each has another zero"), "{}", found.text);
}

#[test]
fn a_logger_that_hangs_is_found() {
    // Ten stretches of 1.2 s.
    let hangs = |session: &mut Csv| (100..2000).step_by(190).for_each(|row| hold(session, &sensors(), row, 12));
    let found = found(hangs, "all sensors held");
    assert!(found.rows[0] >= 101 && (3.0..=6.0).contains(&found.figure), "{found:?}");
    assert!(found.text.contains("check the logger"), "{}", found.text);
}

#[test]
fn a_logger_that_hangs_to_the_end_is_found() {
    let hangs = |session: &mut Csv| hold(session, &sensors(), 1950, 49);
    let found = found(hangs, "all sensors held");
    assert_eq!(found.rows, [1952, 2000]);
}

#[test]
fn imus_whose_last_readings_are_taken_again_are_found() {
    // Each seventh row, 14 %; those in which the arm hardly turns are not counted.
    let held = |session: &mut Csv| (60..1990).step_by(7).for_each(|row| hold(session, &imus(), row, 1));
    let found = found(held, "all IMUs held");
    assert!((5.0..=14.3).contains(&found.figure), "{found:?}");
}

#[test]
fn one_imu_whose_last_reading_is_taken_again_is_found() {
    let names = ["imu5_deg".to_owned()];
    let held = |session: &mut Csv| (60..1990).step_by(20).for_each(|row| hold(session, &names, row, 2));
    let found = found(held, "imu5 held");
    assert!((3.0..=10.0).contains(&found.figure), "{found:?}");
}

#[test]
fn failed_readings_of_zero_are_no_repeats() {
    let zeros = |session: &mut Csv| {
        for row in (150..2000).step_by(150) {
            (row..row + 3).for_each(|row| session.set(row, "imu4_deg", "0.0000"));
        }
    };
    found(zeros, "imu4 zeros");
}

#[test]
fn an_imu_that_repeats_another_one_is_no_exchange() {
    let copy = |session: &mut Csv| {
        let other: Vec<String> = session.rows.iter().map(|row| row[session.column("imu3_deg")].clone()).collect();
        session.map("imu4_deg", |row, cell| if row < 1000 { cell.to_owned() } else { other[row].clone() });
    };
    found(copy, "imu3 and imu4 same_readings");
}

#[test]
fn an_arm_at_rest_whose_readings_are_equal_is_no_fault() {
    let mut session = session();
    hold(&mut session, &sensors(), 0, 40);
    assert!(findings(&session).is_empty());
}

#[test]
fn all_imus_that_return_with_one_turn_are_found() {
    for turn in [18.0, -18.0, 60.0] {
        let found = found(|session| restart(session, &imus(), 1200, turn), "all IMUs new_zero");
        assert_eq!(found.rows, [1201, 1201]);
        assert!((found.figure - turn).abs() < 4.0, "{turn}: {found:?}");
    }
    let mut session = session();
    restart(&mut session, &imus(), 1200, 0.0);
    assert!(findings(&session).is_empty());
}

/// The arm turns back by most of the jump while the IMU is away.
#[test]
fn a_restart_is_found_while_the_arm_turns_back() {
    let mut session = session();
    let headings = session.numbers("imu6_deg");
    let turn_at = |row: usize| {
        let turn = headings[row] - headings[row - 8];
        turn - 360.0 * (turn / 360.0).round()
    };
    let row = (100..1900).max_by(|a, b| turn_at(*a).abs().total_cmp(&turn_at(*b).abs())).expect("rows");
    let turn = turn_at(row);
    assert!(turn.abs() > 30.0, "{turn}");
    restart(&mut session, &["imu6_deg".to_owned()], row, -1.5 * turn);
    let findings = findings(&session);
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!((findings[0].name.as_str(), findings[0].rows[0]), ("imu6 new_zero", row as u64 + 1));
}
