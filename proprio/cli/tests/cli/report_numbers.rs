//! The numbers behind the figures of `report`: JSON and CSV agree, and are those of the session and its estimates.

use serde_json::Value;

use super::common::{Csv, Folder, estimates, json, session, table};

struct Numbers {
    folder: Folder,
    json: Value,
    csv: Csv,
}

/// Of the session and of its first 100 rows.
fn numbers() -> Numbers {
    let folder = Folder::with("one.csv", session().to_string());
    let mut other = session();
    other.rows.truncate(100);
    folder.write("two.csv", other.to_string());
    let args =
        ["report", "one.csv", "two.csv", "--table", table(), "-o", "r.html", "--json", "r.json", "--csv", "r.csv"];
    folder.done(&args);
    let json = serde_json::from_str(&folder.read("r.json")).expect("the file is JSON");
    let csv = folder.csv("r.csv");
    Numbers { folder, json, csv }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list"))
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Panels of one figure of one session, or of all.
fn panels<'j>(json: &'j Value, figure: &str, session: &str) -> Vec<&'j Value> {
    let figures = list(&json["figures"]);
    let figure = figures.iter().find(|found| found["figure"] == figure).unwrap_or_else(|| panic!("no figure {figure}"));
    list(&figure["panels"]).iter().filter(|panel| text(&panel["session"]) == session).collect()
}

fn series<'j>(panel: &'j Value, name: &str, kind: &str) -> &'j Value {
    let found = list(&panel["series"]).iter().find(|series| series["name"] == name && series["kind"] == kind);
    found.unwrap_or_else(|| panic!("no {kind} {name} in {}", panel["name"]))
}

#[test]
fn the_json_has_what_replay_prints() {
    let Numbers { folder, json: found, .. } = numbers();
    let replay = json(&folder.done(&["replay", "one.csv", "two.csv", "--table", table(), "--smooth", "--json"]));
    assert_eq!(found["sessions"], replay["sessions"]);
    assert_eq!(found["all"], replay["all"]);
    assert_eq!(found["table"]["arm"], "planar-6");
    assert_eq!(found["format"], 1);
}

/// Points of all series in the order of the file, in the CSV's form.
fn points(json: &Value) -> Vec<[String; 8]> {
    let mut rows = Vec::new();
    for figure in list(&json["figures"]) {
        for panel in list(&figure["panels"]) {
            for series in list(&panel["series"]) {
                let place = [&figure["figure"], &panel["session"], &panel["name"], &series["name"]].map(text);
                let mut push = |x: &Value, y_name: &Value, y: &Value| {
                    let [a, b, c, d] = place.map(str::to_owned);
                    let (x_name, y_name) = (text(&series["x"]).to_owned(), text(y_name).to_owned());
                    rows.push([a, b, c, d, x_name, number(x).to_string(), y_name, number(y).to_string()]);
                };
                for point in series["points"].as_array().unwrap_or(&Vec::new()) {
                    match (&point[1], text(&series["kind"])) {
                        (Value::Null, _) => {}
                        (range, "band") => {
                            push(&point[0], &series["low"], &range[0]);
                            push(&point[0], &series["high"], &range[1]);
                        }
                        (y, _) => push(&point[0], &series["y"], y),
                    }
                }
            }
        }
    }
    rows
}

#[test]
fn the_csv_has_every_point_of_the_json() {
    let Numbers { json, csv, .. } = numbers();
    assert_eq!(csv.names, ["figure", "session", "panel", "series", "x_quantity", "x", "y_quantity", "y"]);
    let found: Vec<&Vec<String>> =
        csv.rows.iter().filter(|row| !row[4].is_empty() && row[4] != "center_x_mm").collect();
    let expected = points(&json);
    assert_eq!(found.len(), expected.len());
    assert!(expected.len() > 5000, "{}", expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found[..], expected[..]);
    }
}

#[test]
fn the_csv_has_the_figures_of_the_table_boxes_and_panels() {
    let Numbers { json, csv, .. } = numbers();
    let of = |place: [&str; 4], name: &str| {
        let row = csv.rows.iter().find(|row| row[..4] == place && row[6] == name);
        row.unwrap_or_else(|| panic!("no {name} of {place:?}"))[7].clone()
    };
    let rmse_mm = number(&json["all"]["methods"]["fusion"]["tip_rmse_mm"]);
    let found_mm: f64 = of(["table", "", "", "fusion"], "tip_rmse_mm").parse().expect("a number");
    assert!((found_mm / rmse_mm - 1.0).abs() < 1e-14);
    let box_of = panels(&json, "boxes", "two.csv")[0];
    for name in ["low_mm", "quartile1_mm", "median_mm", "quartile3_mm", "high_mm", "largest_mm", "rmse_mm", "samples"] {
        let expected = number(&series(box_of, "bend", "box")[name]);
        assert_eq!(of(["boxes", "two.csv", "", "bend"], name), expected.to_string());
    }
    let drift = panels(&json, "drift", "one.csv")[0];
    let (name, drift_deg) = (text(&drift["name"]), number(&drift["facts"]["drift_deg"]));
    assert_eq!(of(["drift", "one.csv", name, ""], "drift_deg"), drift_deg.to_string());
}

/// Distances of a method's tip from the true one, mm, in order of size.
fn tip_errors_mm(method: &str) -> Vec<f64> {
    let (session, estimates) = (session(), estimates(session()));
    let number = |text: &str| text.parse::<f64>().ok();
    let along = |row: usize, axis: &str| {
        let found = number(estimates.cell(row, &format!("{method}6_{axis}_mm")))?;
        Some(found - number(session.cell(row, &format!("truth6_{axis}_mm")))?)
    };
    let error = |row| Some(f64::hypot(along(row, "x")?, along(row, "y")?));
    let mut errors: Vec<f64> = (0..session.rows.len()).filter_map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// To 10⁻⁴ of the value and the last decimal.
fn assert_near(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() < 1e-4 * expected + 6e-4, "{what}: {found}, expected {expected}");
}

#[test]
fn boxes_are_those_of_the_estimates() {
    let Numbers { json, .. } = numbers();
    for method in ["bend", "imu_o", "imu_c", "fusion"] {
        let errors = tip_errors_mm(method);
        let quantile = |share: f64| {
            let place = share * (errors.len() - 1) as f64;
            let [lo, hi] = [place.floor(), place.ceil()].map(|place| errors[place as usize]);
            lo + (hi - lo) * place.fract()
        };
        let found = series(panels(&json, "boxes", "one.csv")[0], method, "box");
        for (name, share) in [("quartile1_mm", 0.25), ("median_mm", 0.5), ("quartile3_mm", 0.75), ("largest_mm", 1.0)] {
            assert_near(number(&found[name]), quantile(share), &format!("{method} {name}"));
        }
        let reach = 1.5 * (quantile(0.75) - quantile(0.25));
        let inside = |error: &&f64| (quantile(0.25) - reach..=quantile(0.75) + reach).contains(*error);
        assert_near(number(&found["low_mm"]), *errors.iter().find(inside).expect("a whisker"), method);
        assert_near(number(&found["high_mm"]), *errors.iter().rfind(inside).expect("a whisker"), method);
        assert_eq!(found["samples"], errors.len());
    }
}

#[test]
fn the_largest_error_is_seen_over_time_and_as_a_shape() {
    let Numbers { json, .. } = numbers();
    let largest = *tip_errors_mm("fusion").last().expect("there are errors");
    let band = series(panels(&json, "tip_error", "one.csv")[0], "fusion", "band");
    let peaks = list(&band["points"]).iter().filter_map(|point| point[1][1].as_f64());
    assert_near(peaks.fold(0.0, f64::max), largest, "the band");
    let shape = panels(&json, "shapes", "one.csv")[3];
    assert_eq!(shape["name"], "largest error");
    assert_near(number(&shape["facts"]["tip_error_mm"]), largest, "the shape");
}

#[test]
fn circles_are_about_the_tip_with_the_75th_percentile() {
    let Numbers { json, .. } = numbers();
    for panel in &panels(&json, "shapes", "one.csv")[..3] {
        // Before the tare is complete, imu_c has no shape yet.
        let has_shape = |method: &&str| list(&panel["series"]).iter().any(|series| series["name"] == **method);
        for method in ["fusion", "imu_c"].into_iter().filter(has_shape) {
            let circle = series(panel, &format!("{method} 75 %"), "circle");
            let p75 = number(&json["sessions"][0]["methods"][method]["tip_p75_mm"]);
            assert!((number(&circle["radius_mm"]) - p75).abs() < 1e-3);
            let arm = list(&series(panel, method, "line")["points"]).last().expect("a tip");
            assert_eq!([&arm[0], &arm[1]], [&circle["center_x_mm"], &circle["center_y_mm"]]);
        }
    }
}

#[test]
fn drawn_arms_pass_through_the_ends_of_their_segments() {
    let Numbers { json, .. } = numbers();
    let (estimates, panel) = (estimates(session()), panels(&json, "shapes", "one.csv")[1]);
    let time_s = number(&panel["facts"]["time_s"]);
    let row = estimates.numbers("time_s").iter().position(|time| (time - time_s).abs() < 1e-6).expect("a row");
    let drawn = list(&series(panel, "fusion", "line")["points"]);
    for i in 1..=6 {
        for (axis, name) in ["x", "y"].iter().enumerate() {
            let end: f64 = estimates.cell(row, &format!("fusion{i}_{name}_mm")).parse().expect("a number");
            assert!((number(&drawn[8 * i][axis]) - end).abs() < 1e-3, "segment {i}, {name}");
        }
    }
}

/// The last average over the anchor's 10 s is the mean of the last hundred rows.
#[test]
fn moving_averages_are_those_of_the_anchor() {
    let Numbers { json, .. } = numbers();
    let estimates = estimates(session());
    for panel in panels(&json, "drift", "one.csv").iter().filter(|panel| !text(&panel["name"]).ends_with("end")) {
        let segment = text(&panel["name"]).trim_start_matches("segment ");
        let last = list(&series(panel, "bend", "line")["points"]).last().expect("points");
        let angles = estimates.numbers(&format!("bend{segment}_theta_deg"));
        // In a small panel two rows share a point.
        let mean = |to: usize| angles[to - 100..to].iter().sum::<f64>() / 100.0;
        let [whole, paired] = [mean(150), f64::midpoint(mean(149), mean(150))];
        let found = number(&last[1]);
        assert!((found - whole).abs() < 1e-3 || (found - paired).abs() < 1e-3, "{segment}: {found}, {whole}, {paired}");
    }
}

#[test]
fn v_orient_points_are_the_readings_with_the_true_angle() {
    let Numbers { json, .. } = numbers();
    let session = session();
    let panel = panels(&json, "v_orient", "").into_iter().find(|panel| panel["name"] == "bend2b").expect("a sensor");
    let found = list(&series(panel, "true angle", "dots")["points"]);
    let heading = |i: usize| session.numbers(&format!("truth{i}_heading_deg"));
    let volts = session.numbers("bend2b_adc").into_iter().map(|counts| counts * 3.3 / 4095.0);
    for (found, ((volts, before), after)) in found.iter().zip(volts.zip(heading(1)).zip(heading(2))) {
        assert!((number(&found[0]) - volts).abs() < 1e-5 && (number(&found[1]) - (after - before)).abs() < 1e-3);
    }
    assert_eq!(found.len(), 250, "both sessions");
}
