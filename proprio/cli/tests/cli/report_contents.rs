//! Contents of a report other than errors: history of the table, command, times, stated uncertainty, contact, the tip, another table.

use serde_json::Value;

use super::common::{Calibration, Csv, Folder, session, sweep, table};

/// A report of these sessions: its page and its numbers.
fn report(folder: &Folder, sessions: &[&str], options: &[&str]) -> (String, Value) {
    let outputs = ["-o", "report.html", "--json", "report.json", "--csv", "report.csv", "--force"];
    folder.done(&[&["report"], sessions, options, &outputs].concat());
    let numbers = serde_json::from_str(&folder.read("report.json")).expect("the file is JSON");
    (folder.read("report.html"), numbers)
}

/// The panels of a figure.
fn panels<'n>(numbers: &'n Value, figure: &str) -> &'n Vec<Value> {
    let figures = numbers["figures"].as_array().expect("a list");
    let found = figures.iter().find(|found| found["figure"] == figure).unwrap_or_else(|| panic!("no figure {figure}"));
    found["panels"].as_array().expect("a list")
}

fn series<'p>(panel: &'p Value, name: &str) -> &'p Vec<Value> {
    let all = panel["series"].as_array().expect("a list");
    let found = all.iter().find(|series| series["name"] == name && series["kind"] != "band");
    found.unwrap_or_else(|| panic!("no {name} in {}", panel["name"]))["points"].as_array().expect("points")
}

fn blind() -> Csv {
    let mut blind = session();
    blind.remove("truth");
    blind
}

#[test]
fn the_table_has_the_sessions_and_the_day_that_it_was_made_of() {
    let made = Calibration::of(&sweep());
    let folder = made.folder;
    folder.write("session.csv", session().to_string());
    let text = folder.read("table.toml");
    let date = text.split("date = \"").nth(1).and_then(|rest| rest.get(..10)).expect("a day");
    let (page, numbers) = report(&folder, &["session.csv"], &["--table", "table.toml"]);
    assert!(page.contains(&format!("calibrated from sweep.csv on {date}")), "{page}");
    assert_eq!(numbers["table"]["calibration"], serde_json::json!({"sessions": ["sweep.csv"], "date": date}));
}

#[test]
fn the_day_of_a_table_is_that_of_the_build_where_it_is_set() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    let args = ["calibrate", "sweep.csv", "--arm", super::common::arm(), "-o", "table.toml"];
    let status = folder.command(&args).env("SOURCE_DATE_EPOCH", "951782400").output().expect("the tool starts").status;
    assert!(status.success());
    assert!(folder.read("table.toml").contains("date = \"2000-02-29\""));
}

#[test]
fn the_page_shows_the_command_that_has_made_it() {
    let folder = Folder::with("my session.csv", session().to_string());
    let (page, numbers) = report(&folder, &["my session.csv"], &["--table", table()]);
    let command = format!(
        "proprio report 'my session.csv' --table {} -o report.html --json report.json --csv report.csv --force",
        table()
    );
    assert_eq!(numbers["command"], command.as_str());
    assert!(page.contains(&command), "{page}");
}

#[test]
fn a_session_without_truth_shows_the_estimated_tip_over_time() {
    let folder = Folder::with("blind.csv", blind().to_string());
    folder.write("seen.csv", session().to_string());
    let (_, numbers) = report(&folder, &["blind.csv", "seen.csv"], &["--table", table()]);
    let panels = panels(&numbers, "estimate");
    let names: Vec<&Value> = panels.iter().map(|panel| &panel["name"]).collect();
    assert_eq!(names, ["x", "x end", "y", "y end"]);
    assert!(panels.iter().all(|panel| panel["session"] == "blind.csv"));
    folder.done(&["replay", "blind.csv", "--table", table(), "--out", "est.csv"]);
    let tips = folder.csv("est.csv").numbers("fusion6_x_mm");
    let shown = series(&panels[1], "fusion");
    assert_eq!(shown.len(), tips.len());
    for (point, tip) in shown.iter().zip(tips) {
        assert!(point[1].as_f64().map_or(tip.is_nan(), |shown| (shown - tip).abs() < 6e-4), "{point}, {tip}");
    }
}

#[test]
fn the_curve_of_coverage_has_the_share_inside_the_95_percent_ellipse() {
    let folder = Folder::with("session.csv", session().to_string());
    let (_, numbers) = report(&folder, &["session.csv"], &["--table", table()]);
    let [coverage, ratio] = &panels(&numbers, "uncertainty")[..] else { panic!("two panels") };
    let point = series(coverage, "fusion").iter().find(|point| point[0] == 95.0).expect("95 %");
    let inside = numbers["all"]["uncertainty"]["tip_inside_percent"].as_f64().expect("a share");
    // The ellipse of `replay` has the quantile to four digits.
    assert!((point[1].as_f64().expect("a share") - inside).abs() < 0.7, "{point}, {inside}");
    let bins = series(ratio, "fusion").iter().filter_map(|point| point[1].as_f64());
    let squares: Vec<f64> = bins.map(|ratio| ratio * ratio).collect();
    let nees = squares.iter().sum::<f64>() / squares.len() as f64;
    let expected = numbers["all"]["uncertainty"]["tip_nees"].as_f64().expect("a number");
    assert!((nees / expected - 1.0).abs() < 0.02, "{nees}, {expected}");
}

#[test]
fn the_panels_of_the_tip_have_the_estimates_near_it_and_the_ellipse() {
    let folder = Folder::with("session.csv", session().to_string());
    let (_, numbers) = report(&folder, &["session.csv"], &["--table", table()]);
    let panels = panels(&numbers, "shapes");
    for tip in &panels[4..7] {
        let whole = tip["name"].as_str().and_then(|name| name.strip_suffix(" tip")).expect("a panel of the tip");
        let whole = panels.iter().find(|panel| panel["name"] == whole).expect("the whole arm");
        let [fusion, of_whole] = [tip, whole].map(|panel| series(panel, "fusion").last().cloned());
        assert_eq!(fusion, of_whole, "the line ends at the same tip");
        let ellipse = series(tip, "fusion 95 %");
        assert!(ellipse.len() > 10, "{ellipse:?}");
    }
}

#[test]
fn contact_is_that_of_the_estimator_for_each_segment() {
    let folder = Folder::new();
    folder.done(&["simulate", "--scenario", "2", "--seconds", "120", "--seed", "7", "-o", "pushed.csv"]);
    let (_, numbers) = report(&folder, &["pushed.csv"], &["--table", table()]);
    let [panel] = &panels(&numbers, "contact")[..] else { panic!("one panel") };
    assert_eq!(panel["series"].as_array().map(Vec::len), Some(6));
    assert!(panel["facts"]["contact_time_percent"].as_f64().expect("a share") > 0.0);
    let percent = |i: usize| series(panel, &format!("segment {i}")).iter().filter_map(|point| point[1].as_f64());
    assert!((1..=6).any(|i| percent(i).any(|percent| percent > 99.9)));
    assert!((1..=6).all(|i| percent(i).all(|percent| (0.0..=100.0).contains(&percent))));
}

#[test]
fn panels_that_are_compared_have_one_scale() {
    let folder = Folder::with("one.csv", session().to_string());
    folder.done(&["simulate", "--scenario", "1", "--seconds", "60", "--seed", "7", "-o", "two.csv"]);
    let (page, _) = report(&folder, &["one.csv", "two.csv"], &["--table", table()]);
    for figure in ["tip_error", "drift_error", "contact", "boxes"] {
        let section = page.split(&format!("<section id=\"{figure}\">")).nth(1).expect("the figure");
        let section = section.split("</section>").next().unwrap_or_default();
        let labels: Vec<Vec<&str>> = section
            .split("<svg ")
            .skip(1)
            .map(|svg| {
                let texts = svg.split("text-anchor=\"end\"").skip(1);
                texts.filter_map(|text| text.split_once('>')?.1.split('<').next().map(str::trim)).collect()
            })
            .collect();
        assert!(labels.len() > 1 && labels.iter().all(|of| !of.is_empty() && of == &labels[0]), "{figure}: {labels:?}");
    }
}

/// The reference table with larger stated errors.
fn other_table() -> String {
    let text = std::fs::read_to_string(table()).expect("the reference table is committed");
    text.replace("threshold_deg = 0.5", "threshold_deg = 0.7").replace("bias_share = 0.6", "bias_share = 0.9")
}

#[test]
fn another_table_is_compared_on_the_same_sessions() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.write("other.toml", other_table());
    let (page, numbers) = report(&folder, &["session.csv"], &["--table", table(), "--compare", "other.toml"]);
    let compared = folder.read("report.csv");
    let (_, alone) = report(&folder, &["session.csv"], &["--table", "other.toml"]);
    assert_eq!(numbers["comparison"]["sessions"], alone["sessions"]);
    assert_eq!(numbers["comparison"]["table"]["crc32"], alone["table"]["crc32"]);
    let differences = numbers["comparison"]["differences"].as_array().expect("a list");
    let expected = serde_json::json!([
        {"key": "anchor.threshold_deg", "table": 0.5, "other": 0.7},
        {"key": "uncertainty.bias_share", "table": 0.6, "other": 0.9},
    ]);
    assert_eq!(differences, expected.as_array().expect("a list"));
    let rmse_mm = &numbers["comparison"]["all"]["methods"]["fusion"]["tip_rmse_mm"];
    let row = format!("other_table,,,fusion,,,tip_rmse_mm,{rmse_mm}");
    assert!(compared.contains(&row), "{row}");
    let [panel] = &panels(&numbers, "comparison")[..] else { panic!("one panel") };
    for name in ["fusion by table A", "fusion by table B"] {
        assert!(!series(panel, name).is_empty());
    }
    assert!(page.contains("2 parameters of different values") && page.contains("B: other.toml, CRC-32"), "{page}");
}

#[test]
fn a_table_of_another_arm_is_not_compared() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.write("other.toml", other_table().replace("length_mm = 80", "length_mm = 81"));
    let args = ["report", "session.csv", "--table", table(), "--compare", "other.toml", "-o", "report.html"];
    let error = folder.refused(&args);
    assert!(error.starts_with("other.toml: is a table of another arm"), "{error}");
}
