//! Sessions and tables that cannot be tuned: each is refused with the file's name and the expected value, without a table.

use calibration_tables::ArmFile;

use super::common::{Csv, Folder, arm, session, simulate, table};
use super::tune::{TUNE, spoiled, training};

/// The error of a tuning on [`training`] after `edit`.
fn refused(edit: impl FnOnce(&mut Csv)) -> String {
    let mut session = training();
    edit(&mut session);
    let folder = Folder::with("session.csv", session.to_string());
    folder.write("table.toml", spoiled());
    folder.refused(&TUNE)
}

/// The error of a tuning with another table.
fn refused_table(table: &str) -> String {
    let folder = Folder::with("session.csv", training().to_string());
    folder.write("table.toml", table);
    folder.refused(&TUNE)
}

#[test]
fn a_session_without_truth_is_refused_by_its_first_column() {
    let error = refused(|session| session.remove("truth"));
    assert!(error.starts_with("session.csv, line 1: ") && error.contains("truth1_x_mm"), "{error}");
}

/// `replay` takes it for a session without truth.
#[test]
fn truth_without_headings_is_refused_by_their_name() {
    let error = refused(|session| (1..=6).for_each(|i| session.remove(&format!("truth{i}_heading_deg"))));
    assert!(error.starts_with("session.csv, line 1: ") && error.contains("truth1_heading_deg"), "{error}");
}

#[test]
fn truth_of_fewer_segments_is_refused_by_the_first_that_is_missing() {
    let error = refused(|session| session.remove("truth6"));
    assert!(error.starts_with("session.csv, line 1: ") && error.contains("truth6_x_mm"), "{error}");
}

#[test]
fn truth_of_more_segments_is_refused() {
    let error = refused(|session| session.push("truth7_x_mm", "0"));
    assert!(error.starts_with("session.csv, line 1: ") && error.contains("segment 7"), "{error}");
}

/// Makes the truth of some segments empty from a row on.
fn blind(session: &mut Csv, segments: std::ops::RangeInclusive<usize>, from: usize) {
    for (i, part) in segments.flat_map(|i| ["x_mm", "y_mm", "heading_deg"].map(|part| (i, part))) {
        session.map(&format!("truth{i}_{part}"), |row, cell| if row < from { cell.to_owned() } else { String::new() });
    }
}

#[test]
fn truth_that_is_empty_throughout_is_refused() {
    let error = refused(|session| blind(session, 1..=6, 0));
    assert!(error.starts_with("session.csv: the part before the last fifth has 0 samples"), "{error}");
}

#[test]
fn a_tip_that_the_camera_never_saw_is_refused() {
    let error = refused(|session| blind(session, 6..=6, 0));
    assert!(error.starts_with("session.csv: the part before the last fifth has 0 samples"), "{error}");
}

#[test]
fn a_tip_that_the_camera_lost_in_what_is_held_back_is_refused() {
    let error = refused(|session| blind(session, 6..=6, 730));
    assert!(error.starts_with("session.csv: the last fifth, which is for validation, has 10 samples"), "{error}");
    assert!(error.contains("expected at least 50"), "{error}");
}

#[test]
fn a_session_that_is_too_short_to_hold_a_part_back_is_refused() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.write("table.toml", spoiled());
    let error = folder.refused(&TUNE);
    assert!(error.starts_with("session.csv: the last fifth, which is for validation, has 30 samples"), "{error}");
}

#[test]
fn truth_that_never_moves_is_refused() {
    let error = refused(|session| {
        for name in session.names.clone().iter().filter(|name| *name != "time_s") {
            let first = session.cell(0, name).to_owned();
            session.map(name, |_, _| first.clone());
        }
    });
    assert!(error.starts_with("session.csv: the arm never moves: "), "{error}");
    assert!(error.contains("0.0°") && error.contains("expected at least 10°"), "{error}");
}

#[test]
fn truth_with_other_axes_is_refused() {
    let error = refused(|session| {
        (1..=6).for_each(|i| session.swap(&format!("truth{i}_x_mm"), &format!("truth{i}_y_mm")));
    });
    assert!(error.starts_with("session.csv: ") && error.contains("% of the arm's length"), "{error}");
}

#[test]
fn a_table_without_bend_sensors_is_refused() {
    let mut file = ArmFile::parse(&spoiled()).expect("a valid table");
    file.segments.iter_mut().for_each(|segment| segment.bend = Some(Vec::new()));
    let error = refused_table(&file.to_toml());
    assert!(error.starts_with("table.toml: no segment has a bend sensor, expected at least one"), "{error}");
}

#[test]
fn an_arm_description_is_refused() {
    let description = std::fs::read_to_string(arm()).expect("it is committed");
    let error = refused_table(&description);
    assert!(error.starts_with("table.toml: ") && error.contains("arm description"), "{error}");
}

#[test]
fn a_session_of_another_arm_is_refused() {
    let error = refused(|session| session.remove("bend4b_adc"));
    assert!(error.starts_with("session.csv, line 1: ") && error.contains("bend4b_adc"), "{error}");
}

#[test]
fn of_several_sessions_the_bad_one_is_named() {
    let mut bad = simulate("--scenario 2 --seconds 60 --seed 53");
    bad.set(400, "truth3_y_mm", "far");
    let folder = Folder::with("good.csv", training().to_string());
    folder.write("bad.csv", bad.to_string());
    let error = folder.refused(&["tune", "good.csv", "bad.csv", "--table", table(), "-o", "tuned.toml"]);
    assert!(error.starts_with("bad.csv, line 402, column truth3_y_mm: "), "{error}");
}

#[test]
fn neither_a_session_nor_the_table_is_a_place_for_the_output() {
    let folder = Folder::with("session.csv", training().to_string());
    folder.write("table.toml", spoiled());
    for output in ["session.csv", "table.toml"] {
        let error = folder.refused(&["tune", "session.csv", "--table", "table.toml", "-o", output]);
        assert!(error.starts_with(output) && error.contains("read by this command"), "{error}");
    }
}

#[test]
fn an_older_table_stays_when_the_tuning_fails() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.write("table.toml", spoiled());
    folder.write("tuned.toml", "old");
    folder.refused(&TUNE);
    assert_eq!(folder.read("tuned.toml"), "old");
}
