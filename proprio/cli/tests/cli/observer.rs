//! The drift observer compared with the anchor, and the correction of hysteresis.

use std::fs;

use super::common::{Folder, anchored, arm, figure, json};

/// A run of 15 min, and a sweep's tables with the anchor, `anchor.toml`, and as `calibrate` makes them, `observer.toml`.
fn folder(scenario: &str) -> Folder {
    let folder = Folder::new();
    folder.done(&["simulate", "--scenario", "sweep", "--seconds", "900", "--seed", "1", "-o", "sweep.csv"]);
    folder.write("anchored.toml", anchored());
    folder.done(&["calibrate", "sweep.csv", "--arm", "anchored.toml", "-o", "anchor.toml"]);
    folder.done(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "observer.toml"]);
    folder.done(&["simulate", "--scenario", scenario, "--seconds", "900", "--seed", "61", "-o", "session.csv"]);
    folder
}

fn beats_the_anchor(scenario: &str) {
    let folder = folder(scenario);
    let rmse_mm = |table| {
        let report = json(&folder.done(&["replay", "session.csv", "--table", table, "--json"]));
        figure(&report, "fusion", "tip_rmse_mm")
    };
    let (anchor, filter) = (rmse_mm("anchor.toml"), rmse_mm("observer.toml"));
    assert!(filter < anchor * 0.6, "{filter} mm, and {anchor} mm with the anchor");
}

#[test]
fn the_bias_filter_takes_two_fifths_of_the_error_of_free_swings() {
    beats_the_anchor("1");
}

#[test]
fn the_bias_filter_takes_two_fifths_of_the_error_under_pushes() {
    beats_the_anchor("2");
}

#[test]
fn the_bias_filter_takes_two_fifths_of_the_error_around_an_obstacle() {
    beats_the_anchor("3");
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
            // 3e-6 rad and 0.003 mm, and what rounding to six and five decimals adds: steps of the bend angles that the bias
            // filter takes in fixed point add up in its biases, and stay for minutes.
            let most = if column.ends_with("_deg") { 17.4e-5 } else { 0.003_01 };
            assert!(difference.abs() < most, "{column}: {fixed} and {float}");
        }
    }
}

/// An empty cell is 0, as its counterpart must be empty too.
fn number(cell: &str) -> f64 {
    if cell.is_empty() { 0.0 } else { cell.parse().expect("a number") }
}

/// RMSE of the bend sensors' angles on a sweep, with and without compensation of hysteresis.
fn compensated(arm: &str, key: &str) -> [f64; 2] {
    let folder = Folder::new();
    folder.done(&["simulate", "--scenario", "sweep", "--seconds", "300", "--seed", "1", "-o", "sweep.csv"]);
    folder.write("arm.toml", arm);
    ["always", "never"].map(|hysteresis| {
        let options = ["--map", "quadratic", "--hysteresis", hysteresis, "--force", "-o", "table.toml"];
        folder.done(&[&["calibrate", "sweep.csv", "--arm", "arm.toml"][..], &options].concat());
        assert_eq!(folder.read("table.toml").contains(key), hysteresis == "always", "{key}");
        let report = json(&folder.done(&["replay", "sweep.csv", "--table", "table.toml", "--json"]));
        figure(&report, "bend", "theta_rmse_deg")
    })
}

#[test]
fn hysteresis_is_compensated_by_plays_of_the_segments_with_the_anchor() {
    let [with, without] = compensated(&anchored(), "hysteresis = ");
    assert!(with < 0.97 * without, "{with}° and {without}°");
}

#[test]
fn hysteresis_is_compensated_by_the_sensors_memory_with_the_bias_filter() {
    let [with, without] = compensated(&fs::read_to_string(arm()).expect("the reference arm"), "memory = ");
    assert!(with < 0.97 * without, "{with}° and {without}°");
}
