//! `proprio check`: silent on a good session, and each fault is named with its sensor.

use std::sync::OnceLock;

use super::common::{Csv, Folder, arm, json, simulate, sweep, table};

/// 60 s of free swings at 10 Hz.
fn session() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 60 --seed 61")).clone()
}

/// Sensor and kind of each finding.
fn findings(session: &Csv) -> Vec<(String, String)> {
    let folder = Folder::with("session.csv", session.to_string());
    let run = folder.run(&["check", "session.csv", "--table", table(), "--json"]);
    let checked = json(&run);
    let list = checked[0]["findings"].as_array().expect("a list of findings");
    assert_eq!(run.code, Some(i32::from(!list.is_empty())), "{}", run.stderr);
    let text = |value: &serde_json::Value| value.as_str().expect("a text").to_owned();
    list.iter().map(|finding| (text(&finding["sensor"]), text(&finding["kind"]))).collect()
}

/// Findings of the session after an edit.
fn findings_of(edit: impl FnOnce(&mut Csv)) -> Vec<(String, String)> {
    let mut session = session();
    edit(&mut session);
    findings(&session)
}

#[track_caller]
fn assert_found(edit: impl FnOnce(&mut Csv), expected: &[(&str, &str)]) {
    let mut session = session();
    edit(&mut session);
    let expected: Vec<_> = expected.iter().map(|(sensor, kind)| ((*sensor).to_owned(), (*kind).to_owned())).collect();
    assert_eq!(findings(&session), expected);
}

fn number(cell: &str) -> f64 {
    cell.parse().expect("a number")
}

/// Adds `turn` to a heading from a row on.
fn turned(row: usize, cell: &str, from: usize, turn: f64) -> String {
    if row < from { cell.to_owned() } else { format!("{:.4}", (number(cell) + turn).rem_euclid(360.0)) }
}

fn bend_names() -> impl Iterator<Item = String> {
    (1..=6).flat_map(|i| ["a", "b"].map(|place| format!("bend{i}{place}_adc")))
}

#[test]
fn a_good_session_is_clean() {
    let folder = Folder::with("session.csv", session().to_string());
    let run = folder.done(&["check", "session.csv", "--table", table()]);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
}

#[test]
fn a_line_names_sensor_rows_figure_and_remedy() {
    let mut session = session();
    session.map("imu4_deg", |row, cell| turned(row, cell, 300, 90.0));
    (295..300).for_each(|row| session.set(row, "imu4_deg", ""));
    let folder = Folder::with("session.csv", session.to_string());
    let run = folder.run(&["check", "session.csv", "--table", table()]);
    assert_eq!(run.code, Some(1));
    let start = "session.csv: imu4, row 301 (30.000 s): the heading continues ";
    assert!(run.stdout.starts_with(start) && run.stdout.contains("check the IMU's supply"), "{}", run.stdout);
    let run = folder.done(&["replay", "session.csv", "--table", table()]);
    assert!(run.stderr.contains("warning: session.csv: imu4, row 301"), "{}", run.stderr);
    folder.done(&["report", "session.csv", "--table", table(), "-o", "report.html"]);
    assert!(folder.read("report.html").contains("Findings of the session check"));
}

#[test]
fn counts_of_another_adc_are_found() {
    let tenth = |session: &mut Csv| {
        bend_names().for_each(|name| session.map(&name, |_, cell| format!("{}", (number(cell) / 4.0).floor())));
    };
    let mut short = session();
    tenth(&mut short);
    // Too short for twenty steps with motion.
    short.rows.truncate(80);
    assert_eq!(findings(&short), [("all bend sensors".to_owned(), "ten_bits".to_owned())]);
}

/// The figure and the text of the finding about all bend sensors after their counts were multiplied.
fn counts_times(factor: f64) -> (f64, String) {
    let mut session = session();
    let times = |cell: &str| format!("{}", (number(cell) * factor).floor().min(4095.0));
    bend_names().for_each(|name| session.map(&name, |_, cell| times(cell)));
    let folder = Folder::with("session.csv", session.to_string());
    let checked = json(&folder.run(&["check", "session.csv", "--table", table(), "--json"]));
    let list = checked[0]["findings"].as_array().expect("a list of findings");
    assert_eq!((list.len(), &list[0]["kind"]), (1, &"counts".into()), "{list:?}");
    (list[0]["figure"].as_f64().expect("a number"), list[0]["text"].as_str().expect("a text").to_owned())
}

#[test]
fn a_factor_of_all_counts_is_named_with_its_reason() {
    let cases = [
        (3.3 / 5.0, "a reference of 5 V in place of 3.3 V"),
        (5.0 / 3.3, "a reference of 3.3 V in place of 5 V"),
        (1.0 / 4.0, "10 bits in place of 12"),
        (1.0 / 16.0, "8 bits in place of 12"),
    ];
    for (factor, reason) in cases {
        let (found, text) = counts_times(factor);
        assert!((found / factor - 1.0).abs() < 0.05, "{factor}: {text}");
        assert!(text.contains(reason), "{factor}: {text}");
    }
    // No known reason.
    let (found, text) = counts_times(0.8);
    assert!((found / 0.8 - 1.0).abs() < 0.05 && !text.contains("as with"), "{text}");
}

#[test]
fn a_shorted_strip_is_found() {
    let shorted = |session: &mut Csv| (200..400).for_each(|row| session.set(row, "bend2a_adc", "0"));
    assert_found(shorted, &[("bend2a", "rail")]);
}

#[test]
fn repeated_values_are_found() {
    let repeat = |name: &'static str, from: usize| {
        move |session: &mut Csv| {
            let value = session.cell(from, name).to_owned();
            session.map(name, |row, cell| if row < from { cell.to_owned() } else { value.clone() });
        }
    };
    assert_found(repeat("imu4_deg", 250), &[("imu4", "frozen")]);
    assert_found(repeat("bend3b_adc", 250), &[("bend3b", "frozen")]);
    let both = |session: &mut Csv| {
        repeat("bend3a_adc", 250)(session);
        repeat("bend3b_adc", 250)(session);
    };
    assert!(findings_of(both).iter().filter(|(_, kind)| kind == "frozen").count() == 2);
    assert_found(repeat("bend3b_adc", 0), &[("bend3b", "constant")]);
}

#[test]
fn failed_readings_of_zero_are_found() {
    let zeros = |session: &mut Csv| (150..600).step_by(100).for_each(|row| session.set(row, "imu5_deg", "0.0000"));
    let mut session = session();
    zeros(&mut session);
    assert_eq!(findings(&session), [("imu5".to_owned(), "zeros".to_owned())]);
}

#[test]
fn imus_of_one_channel_are_found() {
    let copy = |session: &mut Csv| {
        let other: Vec<String> = session.rows.iter().map(|row| row[session.column("imu3_deg")].clone()).collect();
        session.map("imu4_deg", |row, _| other[row].clone());
    };
    assert_found(copy, &[("imu3 and imu4", "same_readings")]);
}

#[test]
fn exchanged_plugs_are_found() {
    assert_found(|session| session.swap("imu2_deg", "imu5_deg"), &[("imu2 and imu5", "exchanged")]);
    let bends = |session: &mut Csv| {
        session.swap("bend2a_adc", "bend5a_adc");
        session.swap("bend2b_adc", "bend5b_adc");
    };
    assert_found(bends, &[("bend2 and bend5", "exchanged")]);
    assert_found(|session| session.swap("bend1b_adc", "bend4a_adc"), &[("bend1b and bend4a", "exchanged")]);
}

/// An arm whose bend sensors differ so much that the readings of exchanged ones are outside each other's maps.
#[test]
fn exchanged_plugs_of_unlike_bend_sensors_are_found() {
    let folder = Folder::new();
    let simulate = |args: &str| drop(folder.done(&args.split(' ').collect::<Vec<_>>()));
    simulate("simulate --scenario sweep --seconds 600 --seed 9 --arm-seed 107 -o sweep.csv");
    simulate("simulate --scenario 1 --seconds 120 --seed 10 --arm-seed 107 -o session.csv");
    folder.done(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
    let mut session = folder.csv("session.csv");
    for place in ["a", "b"] {
        session.swap(&format!("bend2{place}_adc"), &format!("bend5{place}_adc"));
    }
    folder.write("session.csv", session.to_string());
    let checked = json(&folder.run(&["check", "session.csv", "--table", "table.toml", "--json"]));
    let list = checked[0]["findings"].as_array().expect("a list of findings");
    assert_eq!(list.len(), 1, "{list:?}");
    assert_eq!((&list[0]["sensor"], &list[0]["kind"]), (&"bend2 and bend5".into(), &"exchanged".into()));
}

#[test]
fn headings_in_another_direction_or_unit_are_found() {
    let negative = |cell: &str| format!("{:.4}", (-number(cell)).rem_euclid(360.0));
    assert_found(|session| session.map("imu3_deg", |_, cell| negative(cell)), &[("imu3", "inverted")]);
    let all = |session: &mut Csv| (1..=6).for_each(|i| session.map(&format!("imu{i}_deg"), |_, cell| negative(cell)));
    assert_found(all, &[("all IMUs", "inverted")]);
    let radians = |session: &mut Csv| {
        (1..=6).for_each(|i| {
            session.map(&format!("imu{i}_deg"), |_, cell| format!("{:.4}", number(cell).to_radians()));
        });
    };
    assert_found(radians, &[("all IMUs", "radians")]);
    let one = |session: &mut Csv| session.map("imu5_deg", |_, cell| format!("{:.4}", number(cell).to_radians()));
    assert_found(one, &[("imu5", "radians")]);
}

#[test]
fn quaternions_in_another_order_are_found() {
    let mut session = simulate("--scenario 1 --seconds 60 --seed 61 --imu quaternion");
    for i in 1..=6 {
        for (from, to) in [("qw", "last"), ("qx", "qw"), ("qy", "qx"), ("qz", "qy"), ("last", "qz")] {
            session.rename(&format!("imu{i}_{from}"), &format!("imu{i}_{to}"));
        }
    }
    assert_eq!(findings(&session), [("all IMUs".to_owned(), "quaternion_order".to_owned())]);
}

/// An IMU that is turned by 90° about its y axis, so that its x axis points down: q · (√½, 0, √½, 0).
#[test]
fn an_imu_on_its_side_is_found() {
    let mut session = simulate("--scenario 1 --seconds 60 --seed 61 --imu quaternion");
    let half = 0.5_f64.sqrt();
    for row in 0..session.rows.len() {
        let [w, x, y, z] = ["w", "x", "y", "z"].map(|part| number(session.cell(row, &format!("imu3_q{part}"))));
        let turned = [w - y, x - z, y + w, z + x].map(|part| half * part);
        for (part, value) in ["w", "x", "y", "z"].into_iter().zip(turned) {
            session.set(row, &format!("imu3_q{part}"), &format!("{value:.9}"));
        }
    }
    assert_eq!(findings(&session), [("imu3".to_owned(), "on_its_side".to_owned())]);
}

/// The heading of an IMU on its side whose logger computes it: noise about any value.
#[test]
fn a_heading_of_noise_is_blamed_on_its_imu() {
    let noise = |row: usize| f64::from(((row * 7919) % 1000) as u32) / 1000.0;
    let noisy = |session: &mut Csv| session.map("imu3_deg", |row, _| format!("{:.4}", 170.0 + 8.0 * noise(row)));
    assert_found(noisy, &[("imu3", "unrelated")]);
}

#[test]
fn headings_that_are_not_absolute_are_found_with_a_table_without_a_tare() {
    let text = std::fs::read_to_string(table()).expect("the reference table is committed");
    let seconds = text.lines().find(|line| line.starts_with("seconds = ")).expect("the table has a tare");
    let folder = Folder::with("table.toml", text.replace(seconds, "seconds = 0.0"));
    folder.write("session.csv", session().to_string());
    let run = folder.run(&["check", "session.csv", "--table", "table.toml"]);
    assert!(run.stdout.starts_with("session.csv: all IMUs, rows 1 to 10 "), "{}", run.stdout);
    assert!(run.stdout.contains("tare.seconds = 0") && run.stdout.lines().count() == 1, "{}", run.stdout);
    // Headings from the base's direction, as the camera has them.
    let mut session = session();
    for i in 1..=6 {
        let truth: Vec<f64> = session.numbers(&format!("truth{i}_heading_deg"));
        session.map(&format!("imu{i}_deg"), |row, _| format!("{:.4}", truth[row].rem_euclid(360.0)));
    }
    folder.write("session.csv", session.to_string());
    folder.done(&["check", "session.csv", "--table", "table.toml"]);
}

#[test]
fn a_tare_that_is_bent_or_moves_is_found() {
    let kinds = |motion: &str| {
        let session = simulate(&format!("--scenario 1 --motion {motion} --seconds 30 --seed 5"));
        findings(&session).into_iter().map(|(sensor, kind)| format!("{sensor} {kind}")).collect::<Vec<_>>()
    };
    assert_eq!(kinds("bent-start"), ["arm tare_bent"]);
    assert!(kinds("moving-start").contains(&"arm tare_moves".to_owned()));
}

#[test]
fn times_in_another_unit_are_found() {
    let times =
        |factor: f64| move |session: &mut Csv| session.map("time_s", |_, cell| format!("{:.6}", number(cell) * factor));
    assert_found(times(1000.0), &[("time_s", "time_unit")]);
    assert_found(times(1.0 / 60.0), &[("time_s", "time_unit")]);
}

#[test]
fn times_in_another_unit_are_refused_where_they_would_be_used() {
    let folder = Folder::new();
    let mut sweep = sweep();
    sweep.rows.truncate(2000);
    let cases = [
        (1000.0, "1000.0000 times too large, as milliseconds are", "divide time_s by 1000"),
        (1.0 / 60.0, "0.0167 times too large, as minutes are", "multiply time_s by 60"),
    ];
    for (factor, fault, remedy) in cases {
        let mut session = sweep.clone();
        session.map("time_s", |_, cell| format!("{:.6}", number(cell) * factor));
        folder.write("session.csv", session.to_string());
        let commands: [&[&str]; 4] = [
            &["replay", "session.csv", "--table", table()],
            &["report", "session.csv", "--table", table(), "-o", "report.html"],
            &["calibrate", "session.csv", "--arm", arm(), "-o", "table.toml"],
            &["tune", "session.csv", "--table", table(), "-o", "table.toml"],
        ];
        for command in commands {
            let error = folder.refused(command);
            assert!(error.starts_with("session.csv, column time_s: ") && error.contains(fault), "{command:?}: {error}");
            assert!(folder.run(command).stderr.contains(remedy), "{command:?}");
        }
    }
}

#[test]
fn equal_times_and_gaps_are_found() {
    let whole = |session: &mut Csv| session.map("time_s", |_, cell| format!("{:.0}", number(cell).floor()));
    assert_found(whole, &[("time_s", "equal_times")]);
    assert_found(|session| drop(session.rows.drain(300..330)), &[("time_s", "gaps")]);
}

#[test]
fn a_bend_sensor_that_comes_loose_is_found() {
    let loose = |session: &mut Csv| {
        let shifted = |cell: &str| format!("{}", number(cell) + 250.0);
        session.map("bend3a_adc", |row, cell| if row < 200 { cell.to_owned() } else { shifted(cell) });
    };
    let mut session = session();
    loose(&mut session);
    let found = findings(&session);
    assert!(!found.is_empty() && found.iter().all(|(sensor, _)| sensor == "bend3a"), "{found:?}");
}
