//! `tune` on truth with faults.

use super::common::{Folder, table};
use super::truth_faults::{columns, hold, late, scale, zeros};
use super::tune::{TUNE, load, training};

fn folder(session: &impl ToString) -> Folder {
    let folder = Folder::with("session.csv", session.to_string());
    folder.write("table.toml", load(table()).to_toml());
    folder
}

/// Validation RMSE of the tip with the table as it was, mm, and what the tool wrote.
fn tip_mm(session: &impl ToString) -> (f64, String) {
    let folder = folder(session);
    let run = folder.done(&TUNE);
    let record = load(folder.path("tuned.toml")).tuning.expect("a tuned table has a record");
    (record.validation_before.tip_rmse_mm, run.stdout + &run.stderr)
}

#[test]
fn a_lost_marker_is_left_out_of_the_errors() {
    let (good_mm, text) = tip_mm(&training());
    assert!(text.starts_with("truth of session.csv: markers fit "), "{text}");
    let mut session = training();
    zeros(&mut session, 6, (100..900).step_by(50));
    let (found_mm, text) = tip_mm(&session);
    assert!(text.contains("warning: session.csv: truth6, 16 of rows 101 to 851"), "{text}");
    assert!((found_mm - good_mm).abs() < 0.2, "{found_mm} mm, without the fault {good_mm} mm");
}

#[test]
fn a_late_clock_is_warned_about() {
    let mut session = training();
    late(&mut session, 2);
    let (_, text) = tip_mm(&session);
    assert!(text.contains("ms later than the IMUs; remove the columns of truth"), "{text}");
}

#[test]
fn truth_that_stands_still_while_the_sensors_move_is_refused() {
    let mut session = training();
    let last = session.rows.len() - 1;
    hold(&mut session, &columns(), 0, last);
    let error = folder(&session).refused(&TUNE);
    assert!(error.contains("% of the truth's poses are wrong") && error.contains("repeated"), "{error}");
}

#[test]
fn places_in_metres_are_refused() {
    let mut session = training();
    scale(&mut session, "_mm", 0.001);
    let error = folder(&session).refused(&TUNE);
    assert!(error.ends_with("the places are in metres, in columns of mm"), "{error}");
}
