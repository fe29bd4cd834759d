//! `replay --smooth`: the estimates from all readings of a session, compared with those of a board.

use std::sync::OnceLock;

use super::common::{Csv, Folder, anchored, json, quaternion_session, session, simulate, sweep, table};

const SMOOTH: [&str; 5] = ["replay", "session.csv", "--table", "table.toml", "--smooth"];

/// Five minutes of free swings: longer than a block of the smoother.
fn long_session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 300 --seed 52")).clone()
}

/// A folder with the session and the reference table.
fn folder(session: &Csv) -> Folder {
    let folder = Folder::with("session.csv", session.to_string());
    folder.write("table.toml", std::fs::read_to_string(table()).expect("the reference table is committed"));
    folder
}

/// The smoothed estimates of a session by the reference table.
fn smoothed(session: &Csv) -> Csv {
    let folder = folder(session);
    folder.done(&[&SMOOTH[..], &["--out", "est.csv"]].concat());
    folder.csv("est.csv")
}

/// Tip RMSE of fusion and of the smoothed estimates, mm, and the share inside the smoothed ellipses, %.
fn errors(session: &Csv) -> [f64; 3] {
    let figures = json(&folder(session).done(&[&SMOOTH[..], &["--json"]].concat()));
    let smoothed = &figures["all"]["smoothed"];
    let fusion = &figures["all"]["methods"]["fusion"]["tip_rmse_mm"];
    [fusion, &smoothed["tip_rmse_mm"], &smoothed["uncertainty"]["tip_inside_percent"]]
        .map(|value| value.as_f64().unwrap_or_else(|| panic!("{value} in {figures}")))
}

/// Largest difference of a column over rows of two estimates.
fn difference(one: &Csv, other: &Csv, column: &str) -> f64 {
    let pairs = one.numbers(column).into_iter().zip(other.numbers(column));
    pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

#[test]
fn the_smoothed_tip_is_nearer_to_the_truth_than_that_of_fusion() {
    let [fusion, smoothed, inside] = errors(&long_session());
    assert!(smoothed < fusion, "{smoothed} mm, {fusion} mm by fusion");
    assert!(inside > 88.0, "{inside} % inside");
}

#[test]
fn the_table_has_a_row_of_the_smoothed_estimates_only_where_it_is_asked_for() {
    let folder = folder(&session());
    let text = folder.done(&SMOOTH).stdout;
    let rows = text.lines().filter(|line| line.trim_start().starts_with("smoothed ")).count();
    assert_eq!(rows, 1, "{text}");
    let plain = folder.done(&SMOOTH[..4]).stdout;
    assert!(!plain.contains("smoothed"), "{plain}");
    let plain = folder.done(&[&SMOOTH[..4], &["--json"]].concat()).stdout;
    assert!(!plain.contains("smoothed"), "{plain}");
}

#[test]
fn the_estimates_of_the_methods_are_those_without_smoothing() {
    let folder = folder(&long_session());
    folder.done(&[&SMOOTH[..4], &["--out", "plain.csv"]].concat());
    let plain = folder.read("plain.csv");
    let smoothed = smoothed(&long_session());
    assert_eq!(smoothed.names.len(), 73 + 18);
    assert_eq!(smoothed.names[73..76], ["smoothed1_theta_deg", "smoothed1_x_mm", "smoothed1_y_mm"]);
    for (row, line) in smoothed.rows.iter().zip(plain.lines().skip(1)) {
        assert_eq!(row[..73].join(","), line);
    }
    assert_eq!(smoothed.rows.len(), plain.lines().count() - 1);
}

#[test]
fn the_tare_and_the_end_of_a_session_are_those_of_fusion() {
    let estimates = smoothed(&long_session());
    let last = estimates.rows.len() - 1;
    for i in 1..=6 {
        let at = |row: usize| {
            ["smoothed", "fusion"]
                .map(|of| estimates.cell(row, &format!("{of}{i}_theta_deg")).parse::<f64>().expect("a number"))
        };
        let [smoothed, fusion] = at(3);
        assert!((smoothed - fusion).abs() < 1e-9, "segment {i} in the tare: {smoothed}° for {fusion}°");
        // The last row is smoothed by its own update alone.
        let [smoothed, fusion] = at(last);
        assert!((smoothed - fusion).abs() < 0.2, "segment {i} at the end: {smoothed}° for {fusion}°");
    }
}

/// As a board that was tared again in between: the pieces know nothing of each other.
#[test]
fn each_run_of_the_estimator_in_a_session_is_smoothed_separately() {
    let (first, second) =
        (simulate("--scenario 1 --seconds 120 --seed 53"), simulate("--scenario 2 --seconds 250 --seed 54"));
    let mut both = first.clone();
    both.rows.extend(second.rows.clone());
    let count = first.rows.len();
    both.map("time_s", |row, text| if row < count { text.to_owned() } else { format!("{:.1}", row as f64 / 10.0) });
    both.push("tare", "");
    both.map("tare", |row, _| usize::from(row >= count).to_string());
    let mut pieces = smoothed(&both);
    let mut later = pieces.clone();
    later.rows.drain(..count);
    pieces.rows.truncate(count);
    for i in 1..=6 {
        let column = format!("smoothed{i}_theta_deg");
        for (piece, alone) in [(&pieces, smoothed(&first)), (&later, smoothed(&second))] {
            let difference = difference(piece, &alone, &column);
            assert!(difference < 1e-5, "{column} differs by {difference}°");
        }
    }
}

#[test]
fn a_recording_is_smoothed_as_the_session_that_it_holds() {
    let folder = folder(&quaternion_session());
    folder.done(&["convert", "session.csv", "session.mcap"]);
    folder.done(&["replay", "session.mcap", "--table", "table.toml", "--smooth", "--out", "recorded.csv"]);
    assert_eq!(folder.csv("recorded.csv"), smoothed(&quaternion_session()));
}

#[test]
fn in_floats_the_smoothed_estimates_are_the_same_to_rounding() {
    let folder = folder(&long_session());
    folder.done(&[&SMOOTH[..], &["--float", "--out", "float.csv"]].concat());
    let (float, fixed) = (folder.csv("float.csv"), smoothed(&long_session()));
    for i in 1..=6 {
        let difference = difference(&float, &fixed, &format!("smoothed{i}_x_mm"));
        assert!(difference < 0.01, "{difference} mm");
    }
}

#[test]
fn the_bytes_are_the_same_every_time() {
    let bytes = || smoothed(&session()).to_string();
    assert_eq!(bytes(), bytes());
}

#[test]
fn an_imu_that_dies_halfway_does_not_make_smoothing_worse_than_fusion() {
    let mut session = long_session();
    session.map("imu3_deg", |row, text| if row < 1500 { text.to_owned() } else { String::new() });
    let [fusion, smoothed, inside] = errors(&session);
    assert!(smoothed < 1.1 * fusion, "{smoothed} mm, {fusion} mm by fusion");
    assert!(inside > 88.0, "{inside} % inside");
}

#[test]
fn a_table_with_the_anchor_is_refused() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    folder.write("arm.toml", anchored());
    folder.write("session.csv", session().to_string());
    folder.done(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "table.toml"]);
    let error = folder.refused(&[&SMOOTH[..], &["--out", "est.csv"]].concat());
    assert_eq!(error, "table.toml: corrects the drift by the anchor, whose estimates cannot be smoothed");
}

#[test]
fn a_report_has_the_smoothed_errors_and_their_share_inside_the_ellipse() {
    let folder = folder(&long_session());
    folder.done(&["report", "session.csv", "--table", "table.toml", "-o", "report.html", "--csv", "report.csv"]);
    let page = folder.read("report.html");
    let title = page.split("true tips in the 95 % ellipse: fusion ").nth(1).expect("a title");
    assert!(title.split_once('<').is_some_and(|(title, _)| title.contains(" %, smoothed ")), "{title}");
    let numbers = folder.read("report.csv");
    for start in [
        "table,session.csv,,smoothed,,,tip_inside_percent,",
        "tip_error,session.csv,,smoothed,",
        "boxes,session.csv,,smoothed,",
    ] {
        assert!(numbers.lines().any(|line| line.starts_with(start)), "{start}");
    }
}
