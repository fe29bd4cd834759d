//! `proprio check` on truth: each fault is named with its marker, its rows and its figure.

use std::sync::OnceLock;

use super::common::{Csv, Folder, json, simulate, table};
use super::truth_faults::{columns, exchange, half_turns, hold, late, parts, scale, shift, staircase, zeros};

/// 120 s of free swings at 10 Hz, of which the arm rests for 5 s.
fn session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 120 --seed 161")).clone()
}

/// A finding: sensor, kind, number of rows, first row, figure.
#[derive(Debug)]
struct Found {
    name: String,
    count: u64,
    first: u64,
    last: u64,
    figure: f64,
}

fn findings(edit: impl FnOnce(&mut Csv)) -> Vec<Found> {
    let mut session = session();
    edit(&mut session);
    let folder = Folder::with("session.csv", session.to_string());
    let checked = json(&folder.run(&["check", "session.csv", "--table", table(), "--json"]));
    let found = |finding: &serde_json::Value| {
        let text = |key: &str| finding[key].as_str().expect("a text").to_owned();
        let row = |key: &str| finding["rows"][key].as_u64().expect("a row");
        Found {
            name: format!("{} {}", text("sensor"), text("kind")),
            count: row("count"),
            first: row("first"),
            last: row("last"),
            figure: finding["figure"].as_f64().expect("a figure"),
        }
    };
    checked[0]["findings"].as_array().expect("a list of findings").iter().map(found).collect()
}

/// The only finding after `edit`.
#[track_caller]
fn found(edit: impl FnOnce(&mut Csv), name: &str) -> Found {
    let mut findings = findings(edit);
    assert_eq!(findings.len(), 1, "{findings:?}");
    let found = findings.remove(0);
    assert_eq!(found.name, name);
    found
}

#[test]
fn a_good_session_has_no_finding() {
    let findings = findings(|_| {});
    assert!(findings.is_empty(), "{findings:?}");
}

#[test]
fn zeros_of_a_lost_marker_are_found() {
    let found = found(|session| zeros(session, 4, (200..1100).step_by(150)), "truth4 truth_zeros");
    assert_eq!((found.count, found.first, found.last), (6, 201, 951));
    assert!((found.figure - 0.5).abs() < 1e-9, "6 of 1200 rows are 0.5 %: {}", found.figure);
}

/// The first repeats differ from the arm by less than the rule's 1°.
#[test]
fn a_marker_that_is_held_while_the_arm_moves_is_found() {
    let found = found(|session| hold(session, &parts(5), 700, 30), "truth5 truth_repeated");
    assert!((702..=706).contains(&found.first) && found.last == 731, "{found:?}");
}

#[test]
fn an_arm_at_rest_repeats_its_truth_without_a_finding() {
    let findings = findings(|session| hold(session, &columns(), 0, 40));
    assert!(findings.is_empty(), "{findings:?}");
}

#[test]
fn truth_of_half_the_rate_that_is_held_is_found() {
    for period in [2, 5] {
        let found = found(|session| staircase(session, period), "truth truth_staircase");
        assert!((found.figure - period as f64).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn a_heading_that_was_resampled_over_a_whole_turn_is_found() {
    let found = found(|session| half_turns(session, 3, [400, 640, 913]), "truth3 truth_jump");
    assert_eq!((found.count, found.first, found.last), (3, 401, 914));
}

/// The tip has one neighbour alone.
#[test]
fn a_single_place_of_the_tip_that_is_off_and_back_is_found() {
    let found = found(|session| shift(session, 6, [400, 640, 913], 25.0), "truth6 truth_jump");
    assert_eq!((found.count, found.first, found.last), (3, 401, 914));
}

#[test]
fn a_place_that_no_arm_of_these_lengths_has_is_found() {
    let found = found(|session| shift(session, 2, 500..520, 120.0), "truth2 truth_misplaced");
    assert_eq!((found.count, found.first, found.last), (20, 501, 520));
}

#[test]
fn markers_that_exchange_names_for_a_while_are_found() {
    for pair in [[3, 4], [2, 6]] {
        let name = format!("truth{} and truth{} truth_exchanged", pair[0], pair[1]);
        let found = found(|session| exchange(session, pair, 600..660), &name);
        assert_eq!((found.count, found.first, found.last), (60, 601, 660));
    }
}

#[test]
fn places_in_metres_and_centimetres_are_found() {
    for factor in [0.001, 0.1] {
        let found = found(|session| scale(session, "_mm", factor), "truth truth_unit");
        assert!((found.figure - factor).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn headings_in_radians_are_found() {
    let found = found(|session| scale(session, "_deg", 1_f64.to_radians()), "truth truth_radians");
    assert!((found.figure - 57.3).abs() < 4.0, "{found:?}");
}

/// A description of 90 mm for an arm of 80 mm: here the truth of a smaller arm with the same description.
#[test]
fn lengths_of_another_arm_are_found() {
    for factor in [0.89, 1.03] {
        let found = found(|session| scale(session, "_mm", factor), "truth truth_lengths");
        assert!((found.figure / factor - 1.0).abs() < 0.01, "{found:?}");
    }
}

#[test]
fn a_mirrored_axis_is_found() {
    let found = found(|session| scale(session, "x_mm", -1.0), "truth truth_axes");
    assert!((found.figure + 1.0).abs() < 0.2, "{found:?}");
}

#[test]
fn truth_that_is_late_or_early_is_found() {
    let found = found(|session| late(session, 1), "truth truth_lag");
    assert!((found.figure - 100.0).abs() < 10.0, "{found:?}");
    let early = |session: &mut Csv| {
        // The sensors of three rows earlier.
        let truth = columns();
        for name in session.names.clone().iter().filter(|name| *name != "time_s" && !truth.contains(name)) {
            let cells: Vec<String> = session.rows.iter().map(|row| row[session.column(name)].clone()).collect();
            session.map(name, |row, _| cells[row.saturating_sub(3)].clone());
        }
    };
    let found = self::found(early, "truth truth_lag");
    assert!((found.figure + 300.0).abs() < 10.0, "{found:?}");
}

#[test]
fn a_lag_of_some_seconds_is_found() {
    let found = findings(|session| late(session, 40)).into_iter().find(|found| found.name == "truth truth_lag");
    assert!((found.expect("a lag").figure - 4000.0).abs() < 10.0);
}

#[test]
fn faults_in_the_first_rows_are_found() {
    let found = found(|session| zeros(session, 1, 0..30), "truth1 truth_zeros");
    assert_eq!((found.count, found.first, found.last), (30, 1, 30));
}

#[test]
fn replay_warns_of_truth_and_a_report_lists_it() {
    let mut session = session();
    zeros(&mut session, 4, [300, 500]);
    let folder = Folder::with("session.csv", session.to_string());
    let warning = "truth4, 2 of rows 301 to 501 (30.000 to 50.000 s): the place is exactly 0";
    let run = folder.done(&["replay", "session.csv", "--table", table()]);
    assert!(run.stderr.contains(&format!("warning: session.csv: {warning}")), "{}", run.stderr);
    folder.done(&["report", "session.csv", "--table", table(), "-o", "report.html"]);
    assert!(folder.read("report.html").contains(warning));
}

#[test]
fn truth_without_headings_is_checked_for_zeros_and_distances() {
    let places = |edit: fn(&mut Csv)| {
        findings(|session| {
            edit(session);
            (1..=6).for_each(|i| session.remove(&format!("truth{i}_heading_deg")));
        })
    };
    assert!(places(|_| {}).is_empty());
    let found = places(|session| zeros(session, 4, [300, 500]));
    assert!(found.len() == 1 && found[0].name == "truth4 truth_zeros", "{found:?}");
    let found = places(|session| shift(session, 2, 500..520, 150.0));
    assert!(found.len() == 1 && found[0].name == "truth2 truth_misplaced", "{found:?}");
    assert_eq!(found[0].count, 20);
}

#[test]
fn markers_that_are_exchanged_in_the_whole_session_are_found() {
    for pair in [[5, 6], [1, 2], [3, 6]] {
        let name = format!("truth{} and truth{} truth_exchanged", pair[0], pair[1]);
        let found = found(|session| exchange(session, pair, 0..1200), &name);
        assert_eq!((found.count, found.figure), (1200, 100.0));
    }
}
