//! `simulate --fault`: sessions of an arm whose sensors fail.

use super::common::{Folder, simulate};

const ARGS: &str = "--scenario 1 --seconds 20 --seed 91";

#[test]
fn a_fault_changes_the_cells_of_its_sensor_in_its_time_and_no_other() {
    let good = simulate(ARGS);
    let faulty = simulate(&format!("{ARGS} --fault bend2a:open@10+1,imu3:jump=30@12"));
    for row in 0..good.rows.len() {
        let time_s: f64 = good.cell(row, "time_s").parse().expect("a time");
        for (column, (before, after)) in good.rows[row].iter().zip(&faulty.rows[row]).enumerate() {
            let is_open = column == good.column("bend2a_adc") && (10.0..10.95).contains(&time_s);
            let is_turned = column == good.column("imu3_deg") && time_s > 11.95;
            if is_open {
                assert_eq!(after, "4095");
            } else if is_turned {
                let turn = after.parse::<f64>().expect("a heading") - before.parse::<f64>().expect("a heading");
                assert!((turn.rem_euclid(360.0) - 30.0).abs() < 0.03, "row {row}: {turn}°");
            } else {
                assert_eq!(before, after, "row {row}, column {column}");
            }
        }
    }
}

#[test]
fn an_imu_that_resets_has_empty_cells_for_its_boot_and_begins_at_zero() {
    let session = simulate(&format!("{ARGS} --fault imu3:reset@12"));
    let lost: Vec<usize> = (0..session.rows.len()).filter(|row| session.cell(*row, "imu3_deg").is_empty()).collect();
    assert_eq!(lost, (120..127).collect::<Vec<_>>(), "700 ms");
    let first: f64 = session.cell(127, "imu3_deg").parse().expect("a heading");
    assert!(first.min(360.0 - first) < 2.0, "{first}° one sample after zero");
}

#[test]
fn faults_of_the_board_and_of_sensors_that_are_not_there_are_refused() {
    let folder = Folder::new();
    for (fault, expected) in [
        ("sda:held@1", "fault `sda:held` has no meaning for a session"),
        ("power:cut@1", "fault `power:cut` has no meaning for a session"),
        ("imu8:reset@1", "fault `imu8:reset`: the arm has no such sensor"),
    ] {
        let mut args: Vec<&str> = ["simulate", "-o", "session.csv", "--fault", fault].to_vec();
        args.extend(ARGS.split(' '));
        let error = folder.refused(&args);
        assert!(error.starts_with(expected), "{error}");
        assert!(!folder.path("session.csv").exists());
    }
}

#[test]
fn a_fault_that_is_misspelt_has_status_2_and_an_example() {
    let folder = Folder::new();
    for (fault, expected) in [
        ("imu3:rest@1", "unknown fault `imu3:rest`"),
        ("imu3:reset", "expected the fault and its begin in s, such as imu3:reset@12.5"),
        ("bend2a:factor@1", "expected a value of 0 to 100"),
        ("imu3:reset@1+2", "has no duration"),
    ] {
        let mut args: Vec<&str> = ["simulate", "-o", "session.csv", "--fault", fault].to_vec();
        args.extend(ARGS.split(' '));
        let run = folder.run(&args);
        assert!(run.code == Some(2) && run.stderr.contains(expected), "{fault}: {}", run.stderr);
    }
}
