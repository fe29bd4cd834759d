//! The drift observer beside the anchor, and the correction of hysteresis.

use std::fs;

use super::common::{Folder, arm, figure, json};

/// A run of 15 min, and a sweep's tables with the anchor, `anchor.toml`, and as `calibrate` makes them, `observer.toml`.
fn folder(scenario: &str) -> Folder {
    let folder = Folder::new();
    folder.done(&["simulate", "--scenario", "sweep", "--seconds", "900", "--seed", "1", "-o", "sweep.csv"]);
    let text = fs::read_to_string(arm()).expect("the reference arm");
    folder.write("anchored.toml", text.replacen("[[segment]]", "[drift]\nkind = \"anchor\"\n\n[[segment]]", 1));
    folder.done(&["calibrate", "sweep.csv", "--arm", "anchored.toml", "-o", "anchor.toml"]);
    folder.done(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "observer.toml"]);
    folder.done(&["simulate", "--scenario", scenario, "--seconds", "900", "--seed", "61", "-o", "session.csv"]);
    folder
}

fn halves_the_error(scenario: &str) {
    let folder = folder(scenario);
    let rmse_mm = |table| {
        let report = json(&folder.done(&["replay", "session.csv", "--table", table, "--json"]));
        figure(&report, "fusion", "tip_rmse_mm")
    };
    let (anchor, observer) = (rmse_mm("anchor.toml"), rmse_mm("observer.toml"));
    assert!(observer < anchor / 2.0, "{observer} mm, and {anchor} mm with the anchor");
}

#[test]
fn the_observer_halves_the_error_of_free_swings() {
    halves_the_error("1");
}

#[test]
fn the_observer_halves_the_error_under_pushes() {
    halves_the_error("2");
}

#[test]
fn the_observer_halves_the_error_around_an_obstacle() {
    halves_the_error("3");
}

#[test]
fn fixed_point_and_floats_agree_on_the_drift() {
    let folder = folder("2");
    let args = ["replay", "session.csv", "--table", "observer.toml", "--out"];
    folder.done(&[&args[..], &["fixed.csv"]].concat());
    folder.done(&[&args[..], &["float.csv", "--float"]].concat());
    let [fixed, float] = ["fixed.csv", "float.csv"].map(|name| folder.csv(name));
    let names = &fixed.names;
    for (fixed, float) in fixed.rows.iter().zip(&float.rows) {
        for ((fixed, float), column) in fixed.iter().zip(float).zip(names) {
            assert_eq!(fixed.is_empty(), float.is_empty(), "{column}");
            let difference = number(fixed) - number(float);
            // 1e-6 rad and 0.002 mm, and what rounding to six and five decimals adds.
            let most = if column.ends_with("_deg") { 5.8e-5 } else { 0.002_01 };
            assert!(difference.abs() < most, "{column}: {fixed} and {float}");
        }
    }
}

/// An empty cell is 0, as its counterpart must be empty too.
fn number(cell: &str) -> f64 {
    if cell.is_empty() { 0.0 } else { cell.parse().expect("a number") }
}

#[test]
fn hysteresis_is_corrected_where_it_is_asked_for() {
    let folder = Folder::new();
    folder.done(&["simulate", "--scenario", "sweep", "--seconds", "300", "--seed", "1", "-o", "sweep.csv"]);
    let calibrate = ["calibrate", "sweep.csv", "--arm", arm(), "-o"];
    folder.done(&[&calibrate[..], &["with.toml", "--hysteresis", "always"]].concat());
    folder.done(&[&calibrate[..], &["without.toml", "--hysteresis", "never"]].concat());
    assert_eq!(folder.read("with.toml").matches("hysteresis = ").count(), 6);
    assert_eq!(folder.read("without.toml").matches("hysteresis = ").count(), 0);
    let error_deg = |table| {
        let report = json(&folder.done(&["replay", "sweep.csv", "--table", table, "--json"]));
        figure(&report, "bend", "theta_rmse_deg")
    };
    assert!(error_deg("with.toml") < 0.97 * error_deg("without.toml"), "plays fit the sweep better than none");
}
