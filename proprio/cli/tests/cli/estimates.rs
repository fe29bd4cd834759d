//! The estimate CSV: its columns, its rows, its two number types, and the same bytes every time.

use super::common::{Csv, Folder, estimates, session, table};

const METHODS: [&str; 4] = ["bend", "imu_o", "imu_c", "fusion"];

fn bytes(args: &[&str]) -> String {
    let folder = Folder::with("session.csv", session().to_string());
    let mut all = vec!["replay", "session.csv", "--table", table(), "--out", "est.csv"];
    all.extend(args);
    folder.done(&all);
    folder.read("est.csv")
}

#[test]
fn the_header_is_that_of_the_format() {
    let mut expected = vec!["time_s".to_owned()];
    for method in METHODS {
        for i in 1..=6 {
            expected.extend(["theta_deg", "x_mm", "y_mm"].map(|quantity| format!("{method}{i}_{quantity}")));
        }
    }
    assert_eq!(bytes(&[]).lines().next(), Some(expected.join(",").as_str()));
}

#[test]
fn there_is_a_row_a_sample_with_a_cell_a_column() {
    let estimates = estimates(session());
    assert_eq!(estimates.rows.len(), session().rows.len());
    assert!(estimates.rows.iter().all(|row| row.len() == 73));
}

#[test]
fn times_are_those_of_the_session() {
    let estimates = estimates(session());
    for (row, sample) in session().rows.iter().enumerate() {
        assert_eq!(estimates.cell(row, "time_s"), sample[0]);
    }
}

/// One second at 10 Hz: with the tenth sample the headings' zero is known.
#[test]
fn methods_with_imus_say_nothing_during_the_tare() {
    let estimates = estimates(session());
    let imu: Vec<&String> = estimates.names.iter().filter(|name| name.starts_with("imu_")).collect();
    assert_eq!(imu.len(), 36);
    for row in 0..9 {
        assert!(imu.iter().all(|name| estimates.cell(row, name).is_empty()), "row {row}");
    }
    assert!(imu.iter().all(|name| !estimates.cell(9, name).is_empty()));
}

#[test]
fn bend_sensors_and_fusion_say_all_from_the_first_row() {
    let estimates = estimates(session());
    let first = |name: &&String| name.starts_with("bend") || name.starts_with("fusion");
    assert!(estimates.names.iter().filter(first).all(|name| !estimates.cell(0, name).is_empty()));
}

#[test]
fn headings_that_are_absolute_need_no_tare() {
    let folder = Folder::with("session.csv", session().to_string());
    let reference = std::fs::read_to_string(table()).expect("the reference table is committed");
    folder.write("table.toml", reference.replacen("seconds = 1.0", "seconds = 0.0", 1));
    folder.done(&["replay", "session.csv", "--table", "table.toml", "--out", "est.csv"]);
    let estimates = folder.csv("est.csv");
    let heading = |i: usize| session().cell(0, &format!("imu{i}_deg")).parse::<f64>().expect("a number");
    let found: f64 = estimates.cell(0, "imu_o2_theta_deg").parse().expect("a number");
    let turns = (found - (heading(2) - heading(1))) / 360.0;
    // A heading with five decimals, an angle with six.
    assert!((turns - turns.round()).abs() * 360.0 < 1e-5, "{found}");
}

/// The world points of a method are the chain of its own angles: checked with its formulas in floats.
#[test]
fn points_are_the_chain_of_the_angles() {
    let estimates = estimates(session());
    for method in ["bend", "imu_o"] {
        for row in (9..estimates.rows.len()).step_by(7) {
            check_chain(&estimates, row, method);
        }
    }
}

fn check_chain(estimates: &Csv, row: usize, method: &str) {
    let number = |name: String| estimates.cell(row, &name).parse::<f64>().expect("a number");
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
    for i in 1..=6 {
        let theta = number(format!("{method}{i}_theta_deg")).to_radians();
        let (across, along) =
            if theta == 0.0 { (0.0, 80.0) } else { (80.0 / theta * (1.0 - theta.cos()), 80.0 / theta * theta.sin()) };
        // The connector follows the curve of segments 1, 3, 5 and precedes that of 2, 4, 6.
        let (dx, dy) = if i % 2 == 1 { (17.0 * theta.sin(), 17.0 * theta.cos()) } else { (0.0, 17.0) };
        let (px, py) = (across + dx, along + dy);
        x += px * heading.cos() + py * heading.sin();
        y += -px * heading.sin() + py * heading.cos();
        heading += theta;
        let (found_x, found_y) = (number(format!("{method}{i}_x_mm")), number(format!("{method}{i}_y_mm")));
        // Six angles of six decimals move the tip by up to 6 · 5e-7° · 582 mm = 3e-5 mm; fixed point by 1e-4 mm.
        assert!((found_x - x).abs() < 2e-4 && (found_y - y).abs() < 2e-4, "{method}{i}, row {row}");
    }
}

/// Fixed point is at most 1e-6 rad (5.7e-5°) and 0.002 mm from the reference by design; angles that are not summed up
/// over segments keep well below that.
#[test]
fn fixed_point_and_float_say_the_same() {
    let (fixed, float) = (Csv::parse(&bytes(&[])), Csv::parse(&bytes(&["--float"])));
    assert_eq!(fixed.names, float.names);
    let mut differ = false;
    for (row, (fixed_row, float_row)) in fixed.rows.iter().zip(&float.rows).enumerate() {
        for ((name, fixed), float) in fixed.names.iter().zip(fixed_row).zip(float_row) {
            assert_eq!(fixed.is_empty(), float.is_empty(), "row {row}, {name}");
            let Ok(fixed) = fixed.parse::<f64>() else { continue };
            let error = (fixed - float.parse::<f64>().expect("a number")).abs();
            let limit = if name.ends_with("_deg") { 1e-5 } else { 2e-3 };
            assert!(error < limit, "row {row}, {name}: {error}");
            differ |= error > 0.0;
        }
    }
    assert!(differ, "--float runs another number type");
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    assert!(bytes(&[]) == bytes(&[]));
    assert!(bytes(&["--float"]) == bytes(&["--float"]));
}

#[test]
fn json_and_the_table_do_not_change_the_estimates() {
    assert!(bytes(&[]) == bytes(&["--json"]));
}

#[test]
fn an_arm_without_bend_sensors_has_empty_cells_for_them() {
    let folder = Folder::with("session.csv", session().to_string());
    let description = std::fs::read_to_string(super::common::arm()).expect("the description is committed");
    folder.write("table.toml", description.replace("offset_at", "bend = []\noffset_at"));
    folder.done(&["replay", "session.csv", "--table", "table.toml", "--out", "est.csv"]);
    let (bare, full) = (folder.csv("est.csv"), estimates(session()));
    for name in bare.names.iter().filter(|name| name.starts_with("bend")) {
        assert!(bare.rows.iter().all(|row| row[bare.column(name)].is_empty()), "{name}");
    }
    for name in bare.names.iter().filter(|name| name.starts_with("imu_o")) {
        assert_eq!(bare.cell(120, name), full.cell(120, name), "{name}");
    }
}
