//! One bad cell in the middle of a session: refused with its line, its column and what stands there.

use super::common::{Csv, Folder, quaternion_session, session, table};

/// A row that is read when the estimates are being written already.
const ROW: usize = 120;
/// Its line: the header is line 1.
const LINE: usize = ROW + 2;

fn refused(session: &impl ToString) -> String {
    let folder = Folder::with("session.csv", session.to_string());
    folder.refused(&["replay", "session.csv", "--table", table(), "--out", "est.csv"])
}

/// The error of `value` in `column`, which must name the place, without the place.
fn error_of_cell(mut session: Csv, column: &str, value: &str) -> String {
    session.set(ROW, column, value);
    let (error, place) = (refused(&session), format!("session.csv, line {LINE}, column {column}: "));
    error.strip_prefix(&place).unwrap_or_else(|| panic!("expected {place}, found {error}")).to_owned()
}

/// The error must contain the value.
fn refuses(column: &str, value: &str) {
    let error = error_of_cell(session(), column, value);
    assert!(error.contains(value), "{error}");
}

#[test]
fn text_in_a_number_is_refused() {
    refuses("bend1a_adc", "high");
    refuses("imu4_deg", "12.5deg");
    refuses("truth2_x_mm", "x");
    refuses("time_s", "noon");
}

#[test]
fn hexadecimal_counts_are_refused() {
    refuses("bend1a_adc", "0x10");
}

#[test]
fn nan_is_refused() {
    refuses("bend1a_adc", "NaN");
    refuses("imu4_deg", "nan");
    refuses("truth2_heading_deg", "NaN");
    refuses("time_s", "NaN");
}

#[test]
fn infinity_is_refused() {
    refuses("bend6b_adc", "inf");
    refuses("imu1_deg", "-inf");
    refuses("truth6_y_mm", "infinity");
    refuses("time_s", "1e400");
}

#[test]
fn counts_above_the_converters_range_are_refused() {
    refuses("bend3a_adc", "4096");
}

#[test]
fn negative_counts_are_refused() {
    refuses("bend3a_adc", "-1");
}

#[test]
fn fractions_of_a_count_are_refused() {
    refuses("bend3a_adc", "12.5");
}

#[test]
fn the_converters_lowest_and_highest_count_are_accepted() {
    let mut session = session();
    session.set(ROW, "bend3a_adc", "0");
    session.set(ROW, "bend3b_adc", "4095");
    let folder = Folder::with("session.csv", session.to_string());
    folder.done(&["replay", "session.csv", "--table", table()]);
}

#[test]
fn a_heading_beyond_a_turn_is_refused() {
    refuses("imu5_deg", "400");
    refuses("imu5_deg", "360.01");
}

#[test]
fn a_negative_heading_is_refused() {
    refuses("imu5_deg", "-5");
}

#[test]
fn a_heading_in_rad_is_held_to_a_turn_in_rad() {
    let mut session = session();
    session.map("imu5_deg", |_, _| "1.5".to_owned());
    session.rename("imu5_deg", "imu5_rad");
    assert!(error_of_cell(session, "imu5_rad", "6.5").contains("6.5"));
}

#[test]
fn time_that_goes_backwards_is_refused() {
    let error = error_of_cell(session(), "time_s", "3.25");
    assert!(error.contains("backwards") && error.contains("3.25"), "{error}");
}

#[test]
fn an_empty_time_is_refused() {
    assert!(error_of_cell(session(), "time_s", "").contains("empty"));
}

#[test]
fn a_time_that_is_no_time_is_refused() {
    refuses("time_s", "-1");
    refuses("time_s", "1e12");
}

#[test]
fn a_quaternion_that_is_not_unit_is_refused() {
    let mut session = quaternion_session();
    for (part, value) in [("w", "1"), ("x", "0.5"), ("y", "0"), ("z", "0")] {
        session.set(ROW, &format!("imu2_q{part}"), value);
    }
    let error = refused(&session);
    assert!(error.starts_with(&format!("session.csv, line {LINE}, column imu2_q")), "{error}");
    assert!(error.contains("1.1180"), "the norm is √1.25: {error}");
}

#[test]
fn a_quaternion_of_zeros_is_refused() {
    let mut session = quaternion_session();
    for part in ["w", "x", "y", "z"] {
        session.set(ROW, &format!("imu2_q{part}"), "0");
    }
    assert!(refused(&session).starts_with(&format!("session.csv, line {LINE}, column imu2_q")));
}

#[test]
fn a_partial_quaternion_is_refused() {
    for part in ["w", "x", "y", "z"] {
        let mut session = quaternion_session();
        session.set(ROW, &format!("imu2_q{part}"), "");
        let error = refused(&session);
        assert!(error.starts_with(&format!("session.csv, line {LINE}, column imu2_q")), "{error}");
    }
}

#[test]
fn partial_truth_is_refused() {
    for part in ["x_mm", "y_mm", "heading_deg"] {
        let mut session = session();
        session.set(ROW, &format!("truth3_{part}"), "");
        let error = refused(&session);
        assert!(error.starts_with(&format!("session.csv, line {LINE}, column truth3_")), "{error}");
    }
}

#[test]
fn a_bad_cell_in_the_last_row_is_refused() {
    let mut session = session();
    let last = session.rows.len() - 1;
    session.set(last, "truth6_heading_deg", "-");
    let error = refused(&session);
    assert!(error.starts_with(&format!("session.csv, line {}, column truth6_heading_deg: ", last + 2)), "{error}");
}

#[test]
fn the_line_is_right_in_a_file_of_a_windows_program() {
    let mut session = session();
    session.set(ROW, "imu5_deg", "400");
    let error = refused(&format!("\u{feff}{session}").replace('\n', "\r\n"));
    assert!(error.starts_with(&format!("session.csv, line {LINE}, column imu5_deg: ")), "{error}");
}

#[test]
fn the_line_is_right_below_an_empty_line() {
    let mut session = session();
    session.set(ROW, "imu5_deg", "400");
    let mut lines: Vec<String> = session.to_string().lines().map(str::to_owned).collect();
    lines.insert(LINE - 1, String::new());
    let error = refused(&lines.join("\n"));
    assert!(error.starts_with(&format!("session.csv, line {}, column imu5_deg: ", LINE + 1)), "{error}");
}

#[test]
fn a_bad_cell_among_the_rows_that_are_read_ahead_is_refused_alike() {
    let mut session = session();
    session.set(0, "imu5_deg", "400");
    assert!(refused(&session).starts_with("session.csv, line 2, column imu5_deg: "));
}

#[test]
fn a_refused_session_prints_no_json() {
    let mut session = session();
    session.set(ROW, "bend1a_adc", "high");
    let folder = Folder::with("session.csv", session.to_string());
    folder.refused(&["replay", "session.csv", "--table", table(), "--json"]);
}

#[test]
fn the_second_of_two_sessions_is_the_one_named() {
    let mut bad = session();
    bad.set(ROW, "bend1a_adc", "high");
    let folder = Folder::with("good.csv", session().to_string());
    folder.write("bad.csv", bad.to_string());
    let error = folder.refused(&["replay", "good.csv", "bad.csv", "--table", table()]);
    assert!(error.starts_with(&format!("bad.csv, line {LINE}, column bend1a_adc: ")), "{error}");
}
