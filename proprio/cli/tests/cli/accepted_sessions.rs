//! Sessions that other programs wrote: the same readings in another form give the same estimates.

use std::f64::consts::PI;

use super::common::{Csv, Folder, Run, estimates, figure, json, quaternion_session, report, session, table};

/// The session in another form must give the very same estimates.
fn same_estimates(other: &impl ToString) {
    assert!(estimates(session()) == estimates(other.to_string()));
}

/// Figures of all methods must be as those of the session itself, within `tolerance`.
fn same_figures(other: &Csv, tolerance: f64) {
    let (expected, found) = (report(session()), report(other));
    for method in ["bend", "imu_o", "imu_c", "fusion"] {
        for name in ["tip_rmse_mm", "tip_rmse_percent", "tip_p75_mm", "theta_rmse_deg"] {
            let (expected, found) = (figure(&expected, method, name), figure(&found, method, name));
            assert!((expected - found).abs() < tolerance, "{method} {name}: {found}, expected {expected}");
        }
    }
}

fn replay(session: impl AsRef<[u8]>, args: &[&str]) -> Run {
    let folder = Folder::with("session.csv", session);
    let mut all = vec!["replay", "session.csv", "--table", table()];
    all.extend(args);
    folder.done(&all)
}

#[test]
fn a_byte_order_mark_is_accepted() {
    same_estimates(&format!("\u{feff}{}", session()));
}

#[test]
fn line_ends_of_windows_are_accepted() {
    same_estimates(&session().to_string().replace('\n', "\r\n"));
}

#[test]
fn a_last_line_without_its_end_is_accepted() {
    same_estimates(&session().to_string().trim_end());
}

/// A recording that was cut within its last number looks like this.
#[test]
fn a_last_line_without_its_end_is_warned_about() {
    let run = replay(session().to_string().trim_end(), &[]);
    assert!(run.stderr.starts_with("warning: session.csv: ") && run.warnings().len() == 1, "{}", run.stderr);
}

#[test]
fn spaces_around_names_and_cells_are_accepted() {
    same_estimates(&session().to_string().replace(',', " , "));
}

#[test]
fn quoted_names_and_cells_are_accepted() {
    let quoted = session().to_string().replace(',', "\",\"").replace('\n', "\"\n\"");
    same_estimates(&format!("\"{}", quoted.trim_end_matches('"')));
}

#[test]
fn columns_in_another_order_are_accepted() {
    let mut other = session();
    for row in std::iter::once(&mut other.names).chain(&mut other.rows) {
        row.reverse();
    }
    same_estimates(&other);
}

#[test]
fn unknown_columns_are_ignored() {
    let mut other = session();
    for (name, value) in [("note", "blue arm"), ("imu1_temp", "warm"), ("bend1c_adc", "x"), ("pressure1_kpa", "")] {
        other.push(name, value);
    }
    same_estimates(&other);
}

#[test]
fn unknown_columns_of_one_name_are_ignored() {
    let mut other = session();
    other.push("note", "a");
    other.push("note", "b");
    same_estimates(&other);
}

#[test]
fn whole_counts_with_a_decimal_point_are_accepted() {
    let mut other = session();
    other.map("bend1a_adc", |_, counts| format!("{counts}.0"));
    same_estimates(&other);
}

#[test]
fn a_heading_that_was_rounded_up_to_a_turn_is_north() {
    let (mut north, mut turn) = (session(), session());
    north.set(120, "imu1_deg", "0");
    turn.set(120, "imu1_deg", "360");
    assert!(estimates(north) == estimates(turn));
}

/// A factor of π/180 more or less changes the last of an f64's 16 digits; the report's figures are below 1000.
#[test]
fn headings_in_rad_give_the_same_figures() {
    let mut other = session();
    let names: Vec<String> = other.names.iter().filter(|name| name.ends_with("_deg")).cloned().collect();
    assert_eq!(names.len(), 12, "headings of IMUs and truth");
    for name in names {
        other.map(&name, |_, deg| (deg.parse::<f64>().expect("a number") * PI / 180.0).to_string());
        other.rename(&name, &name.replace("_deg", "_rad"));
    }
    same_figures(&other, 1e-6);
}

#[test]
fn points_in_metres_give_the_same_figures() {
    let mut other = session();
    let names: Vec<String> = other.names.iter().filter(|name| name.ends_with("_mm")).cloned().collect();
    assert_eq!(names.len(), 12, "x and y of the truth");
    for name in names {
        other.map(&name, |_, mm| (mm.parse::<f64>().expect("a number") / 1e3).to_string());
        other.rename(&name, &name.replace("_mm", "_m"));
    }
    same_figures(&other, 1e-9);
}

/// Headings have five decimals, so that each differs by up to 5e-6° from its quaternion: six of them move the tip, half a
/// metre away, by less than 3e-4 mm. The anchored methods may step at its threshold a sample apart.
#[test]
fn quaternions_give_the_figures_of_their_headings() {
    let (expected, found) = (report(session()), report(quaternion_session()));
    for name in ["tip_rmse_mm", "theta_rmse_deg"] {
        let (expected, found) = (figure(&expected, "imu_o", name), figure(&found, "imu_o", name));
        assert!((expected - found).abs() < 3e-4, "{name}: {found}, expected {expected}");
    }
}

#[test]
fn quaternions_come_before_headings() {
    let mut both = quaternion_session();
    for i in 1..=6 {
        both.push(&format!("imu{i}_deg"), "1");
    }
    assert!(estimates(quaternion_session()) == estimates(both));
}

#[test]
fn a_quaternion_and_its_negative_are_the_same_orientation() {
    let mut negative = quaternion_session();
    for part in ["w", "x", "y", "z"] {
        negative.map(&format!("imu3_q{part}"), |row, text| {
            let value: f64 = text.parse().expect("a number");
            if row % 2 == 0 { (-value).to_string() } else { text.to_owned() }
        });
    }
    assert!(estimates(quaternion_session()) == estimates(negative));
}

#[test]
fn a_session_of_one_row_is_accepted() {
    let mut one = session();
    one.rows.truncate(1);
    let report = json(&replay(one.to_string(), &["--json"]));
    assert_eq!((&report["sessions"][0]["samples"], &report["sessions"][0]["seconds"]), (&1.into(), &0.0.into()));
    assert!(figure(&report, "bend", "tip_rmse_mm").is_finite());
}

#[test]
fn rows_of_the_same_time_are_accepted() {
    let mut other = session();
    other.map("time_s", |_, _| "1".to_owned());
    assert_eq!(estimates(other).rows.len(), 150);
}

#[test]
fn figures_without_truth_are_null_in_json() {
    let mut blind = session();
    blind.remove("truth");
    let report = json(&replay(blind.to_string(), &["--json"]));
    for methods in [&report["all"]["methods"], &report["sessions"][0]["methods"]] {
        for method in ["bend", "imu_o", "imu_c", "fusion"] {
            let figures = methods[method].as_object().expect("an object a method");
            assert!(figures.len() == 4 && figures.values().all(serde_json::Value::is_null), "{figures:?}");
        }
    }
}

#[test]
fn a_session_without_truth_gives_the_same_estimates() {
    let mut blind = session();
    blind.remove("truth");
    same_estimates(&blind);
}

/// At 30 Hz steps of 0.03 s and 0.04 s stand for 0.0333 s.
#[test]
fn rounded_time_stamps_give_the_same_estimates() {
    let folder = Folder::new();
    folder.done(&["simulate", "--scenario", "1", "--seconds", "20", "--seed", "6", "--rate", "30", "-o", "exact.csv"]);
    let mut session = folder.csv("exact.csv");
    session.map("time_s", |_, time| format!("{:.2}", time.parse::<f64>().expect("a time")));
    folder.write("rounded.csv", session.to_string());
    let estimates = |name: &str| {
        folder.done(&["replay", &format!("{name}.csv"), "--table", table(), "--force", "--out", "est.csv"]);
        let mut estimates = folder.csv("est.csv");
        estimates.map("time_s", |_, _| String::new());
        estimates
    };
    let (exact, rounded) = (estimates("exact"), estimates("rounded"));
    for (exact, rounded) in exact.rows.iter().flatten().zip(rounded.rows.iter().flatten()) {
        assert_eq!(exact.is_empty(), rounded.is_empty());
        let [exact, rounded] = [exact, rounded].map(|cell| cell.parse::<f64>().unwrap_or(0.0));
        // The bias filter counts in time: a third of a hundredth of a second here and there moves nothing by more.
        assert!((exact - rounded).abs() < 0.1, "{exact} and {rounded} mm or degrees");
    }
}

/// Markers without orientation are a common ground truth.
#[test]
fn truth_without_headings_scores_the_tip_and_no_angle() {
    let mut places = session();
    (1..=6).for_each(|i| places.remove(&format!("truth{i}_heading")));
    same_tip_figures(places);
}

#[test]
fn a_marker_at_the_tip_alone_scores_the_tip() {
    let mut tip = session();
    (1..=5).for_each(|i| tip.remove(&format!("truth{i}_")));
    tip.remove("truth6_heading");
    same_tip_figures(tip);
}

fn same_tip_figures(places: Csv) {
    let (poses, places) = (report(session()), report(places));
    for method in ["bend", "imu_o", "imu_c", "fusion"] {
        for name in ["tip_rmse_mm", "tip_rmse_percent", "tip_p75_mm"] {
            let of = |report: &serde_json::Value| report["all"]["methods"][method][name].clone();
            assert!(of(&places).is_number() && of(&places) == of(&poses), "{method} {name}");
        }
        assert_eq!(places["all"]["methods"][method]["theta_rmse_deg"], serde_json::Value::Null, "{method}");
    }
}
