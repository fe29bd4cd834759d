//! The figures of `replay`: the JSON's keys, and the numbers against the estimates and the truth they come from.

use serde_json::Value;

use super::common::{Folder, estimates, figure, json, report, session, table};

const METHODS: [&str; 4] = ["bend", "fusion", "imu_c", "imu_o"];
const FIGURES: [&str; 4] = ["theta_rmse_deg", "tip_p75_mm", "tip_rmse_mm", "tip_rmse_percent"];
const LENGTH_MM: f64 = 582.0;

/// Keys of an object in alphabetical order.
fn keys(value: &Value) -> Vec<&str> {
    let object = value.as_object().unwrap_or_else(|| panic!("{value} is no object"));
    let mut keys: Vec<&str> = object.keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

fn replay(sessions: &[&str]) -> Value {
    let folder = Folder::with("a.csv", session().to_string());
    let mut other = session();
    other.rows.truncate(100);
    folder.write("b.csv", other.to_string());
    let mut args = vec!["replay", "--table", table(), "--json"];
    args.extend(sessions);
    json(&folder.done(&args))
}

#[test]
fn the_report_has_the_keys_of_the_format() {
    let report = replay(&["a.csv", "b.csv"]);
    assert_eq!(keys(&report), ["all", "sessions"]);
    assert_eq!(keys(&report["all"]), ["methods", "uncertainty"]);
    let sessions = report["sessions"].as_array().expect("a list");
    assert_eq!(sessions.len(), 2);
    for session in sessions {
        assert_eq!(keys(session), ["methods", "path", "samples", "seconds", "uncertainty"]);
        assert_eq!(keys(&session["methods"]), METHODS);
        for method in METHODS {
            assert_eq!(keys(&session["methods"][method]), FIGURES);
        }
    }
}

#[test]
fn sessions_come_in_the_order_of_the_command_line_with_their_paths() {
    let report = replay(&["b.csv", "a.csv"]);
    let paths: Vec<&Value> =
        report["sessions"].as_array().expect("a list").iter().map(|session| &session["path"]).collect();
    assert_eq!(paths, ["b.csv", "a.csv"]);
}

#[test]
fn samples_and_seconds_are_those_of_the_session() {
    let report = replay(&["a.csv", "b.csv"]);
    let extent = |i: usize| (report["sessions"][i]["samples"].as_u64(), report["sessions"][i]["seconds"].as_f64());
    assert_eq!(extent(0), (Some(150), Some(14.9)));
    assert_eq!(extent(1), (Some(100), Some(9.9)));
}

/// Distances of a method's tip from the true one, mm, of the rows that have both.
fn tip_errors_mm(method: &str) -> Vec<f64> {
    let (session, estimates) = (session(), estimates(session()));
    let number = |text: &str| text.parse::<f64>().ok();
    let error = |row: usize| {
        let along = |axis: &str| {
            let found = number(estimates.cell(row, &format!("{method}6_{axis}_mm")))?;
            Some(found - number(session.cell(row, &format!("truth6_{axis}_mm")))?)
        };
        Some(along("x")?.hypot(along("y")?))
    };
    (0..session.rows.len()).filter_map(error).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The estimates have five decimals of a millimetre.
const ROUNDING_MM: f64 = 1e-5;

#[test]
fn the_tip_rmse_is_that_of_the_estimates() {
    let report = report(session());
    for method in METHODS {
        let (expected, found) = (rms(&tip_errors_mm(method)), figure(&report, method, "tip_rmse_mm"));
        assert!((found - expected).abs() < ROUNDING_MM, "{method}: {found}, expected {expected}");
    }
}

#[test]
fn the_tip_rmse_in_percent_is_of_the_arms_length() {
    let report = report(session());
    for method in METHODS {
        let expected = figure(&report, method, "tip_rmse_mm") / LENGTH_MM * 100.0;
        assert!((figure(&report, method, "tip_rmse_percent") - expected).abs() < 1e-12, "{method}");
    }
}

/// Whichever way it is interpolated, as many errors are below the 75th percentile as should be.
#[test]
fn three_quarters_of_the_tip_errors_are_within_the_75th_percentile() {
    let report = report(session());
    for method in METHODS {
        let errors = tip_errors_mm(method);
        let limit = figure(&report, method, "tip_p75_mm") + ROUNDING_MM;
        let share = errors.iter().filter(|error| **error <= limit).count() as f64 / errors.len() as f64;
        assert!((share - 0.75).abs() <= 1.0 / errors.len() as f64, "{method}: {share}");
    }
}

#[test]
fn the_angle_rmse_is_that_of_the_estimates() {
    let (session, estimates, report) = (session(), estimates(session()), report(session()));
    for method in METHODS {
        let mut errors = Vec::new();
        for row in 0..session.rows.len() {
            for i in 1..=6 {
                let heading = |i: usize| match i {
                    0 => 0.0,
                    i => session.cell(row, &format!("truth{i}_heading_deg")).parse::<f64>().expect("a number"),
                };
                if let Ok(theta) = estimates.cell(row, &format!("{method}{i}_theta_deg")).parse::<f64>() {
                    errors.push(theta - (heading(i) - heading(i - 1)));
                }
            }
        }
        let (expected, found) = (rms(&errors), figure(&report, method, "theta_rmse_deg"));
        assert!((found - expected).abs() < 1e-6, "{method}: {found}, expected {expected}");
    }
}

#[test]
fn the_figures_of_one_session_are_those_of_all() {
    let report = replay(&["a.csv"]);
    assert_eq!(report["all"]["methods"], report["sessions"][0]["methods"]);
}

/// `all` is over the samples of all sessions, not a mean of the sessions' figures.
#[test]
fn the_figures_of_all_are_over_all_samples() {
    let report = replay(&["a.csv", "b.csv"]);
    // The bend sensors speak in every row.
    let of = |i: usize| report["sessions"][i]["methods"]["bend"]["tip_rmse_mm"].as_f64().expect("a number");
    let expected = ((150.0 * of(0).powi(2) + 100.0 * of(1).powi(2)) / 250.0).sqrt();
    let found = figure(&report, "bend", "tip_rmse_mm");
    assert!((found - expected).abs() < 1e-9, "{found}, expected {expected}");
    assert!((of(0) - of(1)).abs() > 0.1, "the two differ, else this test shows nothing");
}

#[test]
fn the_table_for_people_has_the_figures_of_the_json() {
    let folder = Folder::with("session.csv", session().to_string());
    let run = folder.done(&["replay", "session.csv", "--table", table()]);
    assert!(run.stdout.starts_with("session.csv: 150 samples, 14.9 s\n\n"), "{}", run.stdout);
    let report = report(session());
    for method in ["bend", "imu_o", "imu_c", "fusion"] {
        let rows: Vec<Vec<&str>> = run
            .stdout
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>())
            .filter(|cells| cells.first() == Some(&method))
            .collect();
        let [row] = &rows[..] else { panic!("one row of {method}: {}", run.stdout) };
        let errors = ["tip_rmse_mm", "tip_rmse_percent", "tip_p75_mm", "theta_rmse_deg"];
        for (cell, name) in row[1..].iter().zip(errors) {
            assert_eq!(*cell, format!("{:.2}", figure(&report, method, name)), "{method} {name}");
        }
        if method == "fusion" {
            let nees = report["all"]["uncertainty"]["tip_nees"].as_f64().expect("a number");
            assert_eq!(row.last(), Some(&format!("{nees:.2}").as_str()));
        }
    }
    assert!(run.stdout.contains("NEES: mean squared error"), "{}", run.stdout);
}

#[test]
fn a_session_without_truth_is_named_in_a_sentence_and_has_no_row() {
    let mut blind = session();
    blind.remove("truth");
    let folder = Folder::with("blind.csv", blind.to_string());
    folder.write("seen.csv", session().to_string());
    let alone = folder.done(&["replay", "blind.csv", "--table", table()]).stdout;
    assert_eq!(alone, "blind.csv: 150 samples, 14.9 s; without truth, so that the errors are not known\n");
    let both = folder.done(&["replay", "blind.csv", "seen.csv", "--table", table()]).stdout;
    assert!(both.starts_with(&alone) && both.matches("blind.csv").count() == 1 && !both.contains('–'), "{both}");
}

#[test]
fn sessions_side_by_side_give_the_output_of_one_by_one() {
    let folder = Folder::new();
    let names: Vec<String> = (1..=6).map(|i| format!("{i}.csv")).collect();
    for (i, name) in (1..).zip(&names) {
        let mut session = session();
        session.rows.truncate(170 - 20 * i);
        // A bend sensor that stands still is a finding, which is a warning.
        (0..session.rows.len()).for_each(|row| session.set(row, "bend3a_adc", "2000"));
        folder.write(name, session.to_string());
    }
    let replay = |names: &[String]| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        folder.done(&[&["replay", "--table", table(), "--json"], &names[..]].concat())
    };
    let all = replay(&names);
    let singles: Vec<_> = names.iter().map(|name| replay(std::slice::from_ref(name))).collect();
    assert!(all.stderr.contains("1.csv: bend3a"), "{}", all.stderr);
    // The count of saturated operations is that of the command.
    let lines =
        |text: &str| text.lines().filter(|line| !line.contains("saturated")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(lines(&all.stderr), singles.iter().flat_map(|run| lines(&run.stderr)).collect::<Vec<_>>());
    let sessions: Vec<Value> = singles.iter().map(|run| json(run)["sessions"][0].clone()).collect();
    assert_eq!(json(&all)["sessions"], Value::Array(sessions));
}
