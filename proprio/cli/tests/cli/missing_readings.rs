//! Empty cells: unknown estimates stay empty, and all others are written.

use super::common::{Csv, estimates, session};

/// Long after the tare, while the arm moves.
const ROW: usize = 120;
const IMU_O: &str = "imu_o";

fn without(names: &[&str], row: usize) -> Csv {
    let mut session = session();
    for name in names {
        session.set(row, name, "");
    }
    estimates(session)
}

/// Segments without an estimate by a method in a row, for its angles and its points.
fn unknown(estimates: &Csv, row: usize, method: &str) -> (Vec<usize>, Vec<usize>) {
    let empty = |quantity: &str| {
        let empty = |i: &usize| estimates.cell(row, &format!("{method}{i}_{quantity}")).is_empty();
        (1..=6).filter(empty).collect::<Vec<_>>()
    };
    let (x, y) = (empty("x_mm"), empty("y_mm"));
    assert_eq!(x, y, "a point is known or not");
    (empty("theta_deg"), x)
}

#[test]
fn a_complete_row_has_no_empty_cell_after_the_tare() {
    let estimates = estimates(session());
    assert!(estimates.rows[9..].iter().flatten().all(|cell| !cell.is_empty()));
}

/// θ_imu,i = h_i − h_{i−1}, so that one heading is in two bend angles.
#[test]
fn a_missing_imu_leaves_two_angles_and_the_points_beyond_empty() {
    assert_eq!(unknown(&without(&["imu2_deg"], ROW), ROW, IMU_O), (vec![2, 3], vec![2, 3, 4, 5, 6]));
}

#[test]
fn the_last_imu_is_in_one_angle_only() {
    assert_eq!(unknown(&without(&["imu6_deg"], ROW), ROW, IMU_O), (vec![6], vec![6]));
}

#[test]
fn a_missing_imu_is_filled_in_by_fusion() {
    let (with, without) = (estimates(session()), without(&["imu2_deg"], ROW));
    assert_eq!(unknown(&without, ROW, "fusion"), (vec![], vec![]));
    assert_ne!(with.cell(ROW, "fusion2_theta_deg"), without.cell(ROW, "fusion2_theta_deg"));
}

#[test]
fn raw_angles_of_other_rows_do_not_mind_a_missing_imu() {
    let (with, without) = (estimates(session()), without(&["imu2_deg"], ROW));
    for row in (0..with.rows.len()).filter(|row| *row != ROW) {
        for name in with.names.iter().filter(|name| name.starts_with(IMU_O)) {
            assert_eq!(with.cell(row, name), without.cell(row, name), "row {row}, {name}");
        }
    }
}

#[test]
fn one_missing_sensor_leaves_the_other() {
    let (with, without) = (estimates(session()), without(&["bend2a_adc"], ROW));
    assert_eq!(unknown(&without, ROW, "bend"), (vec![], vec![]));
    assert_ne!(with.cell(ROW, "bend2_theta_deg"), without.cell(ROW, "bend2_theta_deg"));
    assert_eq!(with.cell(ROW, "bend3_theta_deg"), without.cell(ROW, "bend3_theta_deg"));
}

/// A bend angle is the mean of the sensors that were read.
#[test]
fn both_sensors_give_the_mean_of_what_each_gives_alone() {
    let theta = |estimates: &Csv| estimates.cell(ROW, "bend2_theta_deg").parse::<f64>().expect("a number");
    let alone = ["bend2a_adc", "bend2b_adc"].map(|other| theta(&without(&[other], ROW)));
    let both = theta(&estimates(session()));
    // Three values with six decimals.
    assert!((both - f64::midpoint(alone[0], alone[1])).abs() < 2e-6, "{both} of {alone:?}");
    assert!((alone[0] - alone[1]).abs() > 1e-3, "the two differ, else this test shows nothing");
}

#[test]
fn both_missing_sensors_leave_one_angle_and_the_points_beyond_empty() {
    let estimates = without(&["bend2a_adc", "bend2b_adc"], ROW);
    assert_eq!(unknown(&estimates, ROW, "bend"), (vec![2], vec![2, 3, 4, 5, 6]));
    assert_eq!(unknown(&estimates, ROW, "fusion"), (vec![], vec![]));
}

#[test]
fn a_row_without_readings_keeps_the_fused_shape() {
    let session = session();
    let names = session.names.iter().map(String::as_str);
    let readings: Vec<&str> = names.filter(|name| name.starts_with("bend") || name.starts_with("imu")).collect();
    let estimates = without(&readings, ROW);
    let all: Vec<usize> = (1..=6).collect();
    for method in ["bend", IMU_O, "imu_c"] {
        assert_eq!(unknown(&estimates, ROW, method), (all.clone(), all.clone()), "{method}");
    }
    for name in estimates.names.iter().filter(|name| name.starts_with("fusion")) {
        let [before, after] = [ROW - 1, ROW].map(|row| estimates.cell(row, name).parse::<f64>().expect("it is known"));
        // The update by the row before is in the next one's biases.
        assert!((after - before).abs() < 0.01, "{name}: {before} and then {after}");
    }
}

#[test]
fn there_is_no_estimate_before_the_first_reading() {
    let mut session = session();
    for name in session.names.clone().iter().filter(|name| name.starts_with("bend") || name.starts_with("imu")) {
        session.map(name, |row, cell| if row < 3 { String::new() } else { cell.to_owned() });
    }
    let estimates = estimates(session);
    for row in 0..3 {
        assert!(estimates.rows[row][1..].iter().all(String::is_empty), "row {row}");
    }
    assert!(!estimates.cell(3, "fusion6_x_mm").is_empty());
}

#[test]
fn an_imu_that_was_never_read_leaves_fusion_to_the_bend_sensors() {
    let mut session = session();
    session.map("imu6_deg", |_, _| String::new());
    let estimates = estimates(session);
    for row in 0..estimates.rows.len() {
        assert_eq!(unknown(&estimates, row, "fusion"), (vec![], vec![]));
        assert!(unknown(&estimates, row, IMU_O).0.contains(&6));
    }
    // With nothing else to weigh it follows the bend sensors, late by what the filter remembers; else it stood still.
    let (fused, bend) = (estimates.numbers("fusion6_theta_deg"), estimates.numbers("bend6_theta_deg"));
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    let apart = square(&mut fused.iter().zip(&bend).map(|(fused, bend)| fused - bend));
    let moved = square(&mut bend.iter().map(|theta| theta - bend[0]));
    assert!(apart < 0.01 * moved, "{apart} of {moved}");
}

#[test]
fn truth_that_the_camera_lost_now_and_then_is_accepted() {
    let mut session = session();
    for part in ["x_mm", "y_mm", "heading_deg"] {
        session.map(&format!("truth6_{part}"), |row, cell| if row % 2 == 0 { String::new() } else { cell.to_owned() });
    }
    let report = super::common::report(&session);
    assert_eq!(report["sessions"][0]["samples"], 150);
    assert!(super::common::figure(&report, "bend", "tip_rmse_mm") > 0.0);
}
