//! `proprio check`: drift, an ADC's reference that is off, few swings, and single rows that are held.

use super::common::{Csv, Folder, json, simulate, table};

/// Drift of the examples, deg/s, and the row that it begins at, at 10 Hz.
const DRIFT: f64 = 1.0;
const BEGIN: usize = 600;

fn session() -> Csv {
    simulate("--scenario 1 --seconds 180 --seed 61")
}

/// Sensor, kind and text of each finding.
fn findings(session: &Csv) -> Vec<[String; 3]> {
    let folder = Folder::with("session.csv", session.to_string());
    let checked = json(&folder.run(&["check", "session.csv", "--table", table(), "--json"]));
    let list = checked[0]["findings"].as_array().expect("a list of findings");
    let text = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    list.iter().map(|finding| ["sensor", "kind", "text"].map(|key| text(&finding[key]))).collect()
}

/// The text of the only finding.
#[track_caller]
fn text_of(session: &Csv, sensor: &str, kind: &str) -> String {
    let [[found, of_kind, text]] = <[_; 1]>::try_from(findings(session)).expect("one finding");
    assert_eq!((found.as_str(), of_kind.as_str()), (sensor, kind), "{text}");
    text
}

/// Drift up to a row, deg.
fn drift(row: usize) -> f64 {
    row.saturating_sub(BEGIN) as f64 / 10.0 * DRIFT
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

fn drifting_imu(session: &mut Csv, name: &str) {
    session.map(name, |row, cell| format!("{:.4}", (number(cell) + drift(row)).rem_euclid(360.0)));
}

/// Counts of a bend sensor for a degree of its segment: the regression of the readings on the true angle.
fn counts_per_degree(session: &Csv, name: &str, segment: usize) -> f64 {
    let headings = |k: usize| session.numbers(&format!("truth{k}_heading_deg"));
    let angles: Vec<f64> =
        headings(segment).iter().zip(headings(segment - 1)).map(|(end, start)| end - start).collect();
    let counts = session.numbers(name);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (angle, count) = (mean(&angles), mean(&counts));
    let products = angles.iter().zip(&counts).map(|(of, counts)| (of - angle) * (counts - count)).sum::<f64>();
    products / angles.iter().map(|of| (of - angle).powi(2)).sum::<f64>()
}

#[test]
fn an_imu_that_drifts_is_named_by_its_two_segments() {
    let mut session = session();
    drifting_imu(&mut session, "imu4_deg");
    let text = text_of(&session, "imu4", "drift");
    assert!(text.starts_with("imu4, rows 601 to 1800 (60.000 to 179.900 s): the heading drifts by 1"), "{text}");
}

#[test]
fn drift_at_the_tip_is_not_attributed() {
    let mut session = session();
    drifting_imu(&mut session, "imu6_deg");
    let text = text_of(&session, "imu6 or bend6", "drift");
    assert!(text.contains("it cannot be told which of them drifts"), "{text}");
}

#[test]
fn bend_sensors_that_drift_together_are_told_from_an_imu() {
    let mut session = session();
    for name in ["bend3a_adc", "bend3b_adc"] {
        let slope = counts_per_degree(&session, name, 3);
        // Further, they would leave their maps.
        session.map(name, |row, cell| format!("{:.0}", number(cell) + slope * drift(row).min(30.0)));
    }
    let text = text_of(&session, "bend3a and bend3b", "drift");
    assert!(text.contains("unless all IMUs from imu3 on drift alike"), "{text}");
}

#[test]
fn a_reference_of_the_adc_that_is_off_is_found() {
    for (factor, said) in [(0.96, "the counts are 0.9"), (1.04, "the counts are 1.0")] {
        let mut session = session();
        for name in (1..=6).flat_map(|i| ["a", "b"].map(|place| format!("bend{i}{place}_adc"))) {
            session.map(&name, |_, cell| format!("{:.0}", number(cell) * factor));
        }
        let text = text_of(&session, "all bend sensors", "counts");
        assert!(text.contains(said) && !text.contains("as with"), "{text}");
    }
}

#[test]
fn exchanged_plugs_are_found_by_few_swings() {
    let mut session = session();
    // 12 s with motion.
    session.rows.truncate(170);
    assert_eq!(findings(&session), Vec::<[String; 3]>::new());
    session.swap("imu2_deg", "imu5_deg");
    text_of(&session, "imu2 and imu5", "exchanged");
    session.swap("imu2_deg", "imu5_deg");
    for place in ["a", "b"] {
        session.swap(&format!("bend2{place}_adc"), &format!("bend5{place}_adc"));
    }
    text_of(&session, "bend2 and bend5", "exchanged");
}

#[test]
fn single_rows_that_are_held_at_100_hz_are_found() {
    let mut session = simulate("--scenario 1 --seconds 20 --rate 100 --seed 61");
    assert_eq!(findings(&session), Vec::<[String; 3]>::new());
    let names: Vec<String> = session.names.iter().filter(|name| !name.starts_with('t')).cloned().collect();
    for row in (600..2000).step_by(10) {
        for name in &names {
            let before = session.cell(row - 1, name).to_owned();
            session.set(row, name, &before);
        }
    }
    let text = text_of(&session, "all sensors", "held");
    assert!(text.starts_with("all sensors, 140 of rows 601 to 1991 "), "{text}");
}
