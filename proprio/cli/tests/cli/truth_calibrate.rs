//! `calibrate` on truth with faults: they are named and left out, and the table is as good as one of the whole truth.

use std::sync::OnceLock;

use super::common::{Calibration, Csv, Folder, arm, figure, json, simulate, sweep};
use super::truth_faults::{columns, exchange, half_turns, hold, late, number, parts, scale, shift, staircase, zeros};

/// RMSE of the fused tip on a session of another motion, by a calibration's table, mm.
fn tip_rmse_mm(calibration: &Calibration) -> f64 {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    let session = SESSION.get_or_init(|| simulate("--scenario 1 --seconds 120 --seed 162"));
    calibration.folder.write("session.csv", session.to_string());
    let report = calibration.folder.done(&["replay", "session.csv", "--table", "table.toml", "--json"]);
    figure(&json(&report), "fusion", "tip_rmse_mm")
}

/// The calibration after `edit`, which must warn so, once, and err by no more than half a millimetre over the good one.
#[track_caller]
fn assert_left_out(edit: impl FnOnce(&mut Csv), warning: &str) {
    static GOOD_MM: OnceLock<f64> = OnceLock::new();
    let good_mm = *GOOD_MM.get_or_init(|| tip_rmse_mm(&Calibration::of(&sweep())));
    let mut session = sweep();
    edit(&mut session);
    let calibration = Calibration::of(&session);
    let lines = calibration.run.stderr.lines().filter(|line| line.starts_with("warning: sweep.csv: truth"));
    let lines: Vec<&str> = lines.collect();
    assert!(lines.len() == 1 && lines[0].contains(warning), "{lines:?}");
    let found_mm = tip_rmse_mm(&calibration);
    assert!((found_mm - good_mm).abs() < 0.5, "{found_mm} mm, without the fault {good_mm} mm");
}

fn refused(edit: impl FnOnce(&mut Csv)) -> String {
    let mut session = sweep();
    edit(&mut session);
    let folder = Folder::with("sweep.csv", session.to_string());
    folder.refused(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"])
}

/// Seven rows of the 6000.
fn seven() -> impl Iterator<Item = usize> {
    (500..6000).step_by(800)
}

#[test]
fn lengths_and_clock_of_good_truth_are_printed_without_a_warning() {
    let run = Calibration::of(&sweep()).run;
    let line = run.stdout.lines().next().expect("a line");
    let scale = line.strip_prefix("truth of sweep.csv: markers fit ").and_then(|rest| rest.split(' ').next());
    let scale = number(scale.unwrap_or_else(|| panic!("{line}")));
    assert!((scale - 1.0).abs() < 0.01, "{line}");
    assert!(line.ends_with("than the IMUs"), "{line}");
    assert!(!run.stderr.contains("truth"), "{}", run.stderr);
}

#[test]
fn seven_rows_of_a_lost_marker_are_left_out() {
    assert_left_out(|session| zeros(session, 4, seven()), "truth4, 7 of rows 501 to 5301");
}

#[test]
fn seven_headings_that_were_resampled_over_a_turn_are_left_out() {
    assert_left_out(|session| half_turns(session, 3, seven()), "truth3, 7 of rows 501 to 5301");
}

#[test]
fn a_marker_that_was_held_for_20_s_is_left_out() {
    assert_left_out(|session| hold(session, &parts(2), 3000, 200), "truth2, ");
}

#[test]
fn truth_of_a_fifth_of_the_rate_is_left_out_where_it_is_held() {
    assert_left_out(|session| staircase(session, 5), "the truth changes every 5 rows");
}

#[test]
fn a_place_beyond_the_arms_length_is_left_out() {
    assert_left_out(|session| shift(session, 5, 3000..3300, 100.0), "truth5, rows 3001 to 3300");
}

#[test]
fn markers_that_exchange_names_for_a_minute_are_left_out() {
    assert_left_out(|session| exchange(session, [3, 5], 3000..3600), "truth3 and truth5, rows 3001 to 3600");
}

#[test]
fn truth_of_which_a_fourth_is_wrong_is_refused_with_its_share() {
    let error = refused(|session| {
        for i in 1..=6 {
            zeros(session, i, (i..6000).step_by(4));
        }
    });
    assert!(error.starts_with("sweep.csv: 25 % of the truth's poses are wrong, expected at most 20 %"), "{error}");
}

#[test]
fn a_late_clock_is_warned_about_with_lag_sign_and_remedy() {
    let mut session = sweep();
    late(&mut session, 1);
    let run = Calibration::of(&session).run;
    let warning = run.stderr.lines().find(|line| line.contains("later than the IMUs")).expect("a warning");
    let ms = warning.split("the truth is ").nth(1).and_then(|rest| rest.split(' ').next()).map(number);
    assert!(ms.is_some_and(|ms| (ms - 100.0).abs() < 10.0), "{warning}");
    assert!(warning.contains("proprio align"), "{warning}");
}

#[test]
fn lengths_that_differ_by_three_percent_are_warned_about_in_mm() {
    let mut session = sweep();
    scale(&mut session, "_mm", 1.03);
    let run = Calibration::of(&session).run;
    let text = "the markers fit lengths of 82.";
    assert!(run.stderr.contains(text) && run.stderr.contains("the arm description has 80 mm"), "{}", run.stderr);
}

/// The description of an arm of 90 mm.
#[test]
fn lengths_that_differ_by_a_tenth_are_refused_in_mm() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    let description = std::fs::read_to_string(arm()).expect("the description is committed");
    let longer =
        description.replace("length_mm = 80", "length_mm = 90").replace("offset_mm = 17.0", "offset_mm = 19.1");
    assert_ne!(longer, description);
    folder.write("arm.toml", longer);
    let error = folder.refused(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "table.toml"]);
    assert!(error.starts_with("sweep.csv: the markers fit lengths of 80."), "{error}");
    assert!(error.ends_with("the arm description has 90 mm"), "{error}");
}

#[test]
fn other_units_are_refused_by_name() {
    let error = refused(|session| scale(session, "_mm", 0.001));
    assert!(error.ends_with("the places are in metres, in columns of mm"), "{error}");
    let error = refused(|session| scale(session, "_mm", 0.1));
    assert!(error.ends_with("the places are in centimetres, in columns of mm"), "{error}");
    let error = refused(|session| scale(session, "_deg", 1_f64.to_radians()));
    assert!(error.contains("as radians in columns of degrees"), "{error}");
}

#[test]
fn imus_of_one_channel_are_not_called_swapped() {
    let error = refused(|session| {
        let other: Vec<String> = session.rows.iter().map(|row| row[session.column("imu3_deg")].clone()).collect();
        session.map("imu4_deg", |row, _| other[row].clone());
    });
    assert!(error.contains("imu3 and imu4 give the same readings: both are of one mux channel"), "{error}");
}

/// Bad readings in a third of the sweep: its pieces there fit nothing, the others do.
#[test]
fn an_imu_with_bad_readings_for_a_while_is_not_called_swapped() {
    let mut session = sweep();
    session.map(
        "imu4_deg",
        |row, cell| {
            if (2000..4000).contains(&row) { (row * 7919 % 360).to_string() } else { cell.to_owned() }
        },
    );
    let calibration = Calibration::of(&session);
    assert_eq!(calibration.run.code, Some(0));
}

/// The camera has exchanged two names for a third of the sweep; poses are removed, and the sensors are not called swapped.
#[test]
fn sensors_are_not_called_swapped_for_what_the_camera_has_exchanged() {
    let mut session = sweep();
    exchange(&mut session, [3, 4], 2000..3500);
    let run = Calibration::of(&session).run;
    assert!(run.stderr.contains("truth3 and truth4, rows 2001 to 3500"), "{}", run.stderr);
}

#[test]
fn every_cell_of_a_session_at_rest_may_be_repeated() {
    let mut session = sweep();
    hold(&mut session, &columns(), 0, 40);
    let run = Calibration::of(&session).run;
    assert!(!run.stderr.contains("repeated"), "{}", run.stderr);
}

#[test]
fn markers_that_are_exchanged_in_the_whole_session_are_blamed_and_not_the_arm() {
    let error = refused(|session| exchange(session, [5, 6], 0..6000));
    assert!(error.contains("truth5 and truth6, rows 1 to 6000"), "{error}");
    assert!(error.contains("each has the pose of the other in 100.00 % of the rows"), "{error}");
}
