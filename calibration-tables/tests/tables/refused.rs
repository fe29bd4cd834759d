//! Rejected files: the error has the key, the value found and the expected values.

use calibration_tables::{ArmFile, FileError};

use super::common::{DESCRIPTION, TABLE, edited};

/// The error of the table with another text in one place.
fn error(from: &str, to: &str) -> FileError {
    ArmFile::parse(&edited(from, to)).expect_err("it must be refused")
}

/// Asserts that the error is of this key, and contains the value found.
fn refuses(from: &str, to: &str, key: &str, found: &str) {
    let error = error(from, to);
    let text = error.to_string();
    assert!(matches!(error, FileError::Value { .. }), "{to}: {text}");
    let (line, text) = text.strip_prefix("line ").and_then(|text| text.split_once(": ")).expect("the line");
    assert!(line.parse::<usize>().is_ok() && text.starts_with(key), "{to}: {text}");
    assert!(text[key.len()..].contains(found) && text.contains("expected"), "{to}: {text}");
}

#[test]
fn a_value_is_named_with_its_own_line() {
    let text = edited("window = 100", "window = 0");
    let expected = 1 + text.lines().position(|line| line == "window = 0").expect("the edited line");
    let error = ArmFile::parse(&text).expect_err("it must be refused");
    assert!(matches!(error, FileError::Value { line: Some(line), .. } if line == expected), "{error}");
}

#[test]
fn a_third_voltage_is_refused() {
    let error = error("volts = [0.4, 2.6]", "volts = [0.4, 2.6, 9.0]");
    assert!(error.to_string().contains("3 numbers, expected 2"), "{error}");
}

/// Asserts that the error is one of syntax, at this line and column of the file, and contains `what`.
fn refuses_at(text: &str, [line, column]: [usize; 2], what: &str) {
    let error = ArmFile::parse(text).expect_err("it must be refused");
    assert!(matches!(error, FileError::Syntax { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains(&format!("line {line}, column {column}")) && text.contains(what), "{text}");
}

#[test]
fn a_syntax_error_names_line_and_column() {
    refuses_at(&edited("window = 100", "window = = 100"), [11, 10], "");
    refuses_at(&edited("\"finger\"", "\"finger"), [3, 14], "");
}

#[test]
fn a_value_of_the_wrong_type_names_line_and_column() {
    refuses_at(&edited("window = 100", "window = \"long\""), [11, 10], "long");
    refuses_at(&edited("rate_hz = 10.0", "rate_hz = true"), [4, 11], "");
}

#[test]
fn the_line_is_right_behind_a_byte_order_mark() {
    refuses_at(&format!("\u{feff}{}", edited("window = 100", "window = = 100")), [11, 10], "");
}

#[test]
fn an_unknown_key_is_named() {
    refuses_at(&edited("window = 100", "windw = 100"), [11, 1], "windw");
    refuses_at(&edited("rate_hz", "rate_khz"), [4, 1], "rate_khz");
    refuses_at(&edited("seconds", "second"), [7, 1], "second");
    refuses_at(&edited("length_mm", "length_m"), [16, 1], "length_m");
    refuses_at(&edited("rmse_deg", "rmse"), [19, 42], "rmse");
    refuses_at(&edited("r_imu", "r_imuu"), [20, 22], "r_imuu");
}

#[test]
fn a_missing_key_is_named() {
    for key in ["arm", "rate_hz", "length_mm", "offset_mm", "offset_at"] {
        let lines = DESCRIPTION.lines().filter(|line| !line.starts_with(&format!("{key} =")));
        let text: String = lines.flat_map(|line| [line, "\n"]).collect();
        let error = ArmFile::parse(&text).expect_err("it must be refused");
        assert!(error.to_string().contains(&format!("`{key}`")), "{key}: {error}");
    }
}

#[test]
fn a_missing_format_is_named() {
    let error = error("format = 1\n", "");
    assert!(error.to_string().contains("`format`"), "{error}");
}

/// A file of another version has unknown keys: the error is about the format, not the keys.
#[test]
fn another_format_is_named_before_its_unknown_keys() {
    let error = ArmFile::parse("format = 2\nspline = true\n").expect_err("it must be refused");
    assert!(matches!(error, FileError::Format(2)), "{error}");
    assert!(error.to_string().contains("format = 2") && error.to_string().contains("format = 1"), "{error}");
}

#[test]
fn a_format_that_is_no_number_is_refused() {
    refuses_at(&edited("format = 1", "format = \"1\""), [2, 10], "");
}

#[test]
fn an_arm_without_segments_is_refused() {
    let text = "format = 1\narm = \"none\"\nrate_hz = 10.0\nsegment = []\n";
    let error = ArmFile::parse(text).expect_err("it must be refused").to_string();
    assert!(error.contains("segment = 0") && error.contains("1 to 16"), "{error}");
}

#[test]
fn seventeen_segments_are_refused() {
    let (head, segment) = DESCRIPTION.split_once("[[segment]]").expect("it has a segment");
    let text = format!("{head}{}", format!("[[segment]]{segment}").repeat(17));
    let error = ArmFile::parse(&text).expect_err("it must be refused").to_string();
    assert!(error.contains("segment = 17") && error.contains("1 to 16"), "{error}");
}

#[test]
fn lengths_that_are_none_are_refused() {
    refuses("length_mm = 80.0", "length_mm = -80.0", "segment[1].length_mm", "-80");
    refuses("length_mm = 60.0", "length_mm = 0.0", "segment[2].length_mm", "0");
    refuses("offset_mm = 17.0", "offset_mm = -1.0", "segment[1].offset_mm", "-1");
}

#[test]
fn an_arm_that_fixed_point_cannot_hold_is_refused() {
    refuses("length_mm = 80.0", "length_mm = 15999.0", "segment = ", "mm of arm");
}

#[test]
fn nan_and_infinity_are_refused_in_every_number() {
    let numbers = [
        ("rate_hz = 10.0", "rate_hz"),
        ("seconds = 1.0", "tare.seconds"),
        ("threshold_deg = 0.5", "anchor.threshold_deg"),
        ("length_mm = 80.0", "segment[1].length_mm"),
        ("offset_mm = 17.0", "segment[1].offset_mm"),
        ("c0 = -1.5", "segment[1].bend[1].c0"),
        ("c1 = 0.8", "segment[1].bend[1].c1"),
        ("c2 = 0.1", "segment[1].bend[1].c2"),
        ("rmse_deg = 4.7", "segment[1].bend[1].rmse_deg"),
        ("q = 0.16", "segment[1].orient.q"),
        ("r_imu = 0.0002", "segment[1].orient.r_imu"),
        ("r_bend = 0.002", "segment[1].orient.r_bend"),
        ("h_imu = 1.0", "segment[1].orient.h_imu"),
        ("h_bend = 1.0", "segment[1].orient.h_bend"),
        ("q = 0.0002", "segment[1].coord.q"),
        ("r_imu = 3e-7", "segment[1].coord.r_imu"),
    ];
    for (line, key) in numbers {
        let name = line.split(' ').next().expect("a key");
        for value in ["nan", "inf", "-inf"] {
            let found = if value == "nan" { "NaN" } else { value };
            refuses(line, &format!("{name} = {value}"), key, found);
        }
    }
    refuses("[5.0, -5.0]", "[5.0, nan]", "tare.heading_deg[2]", "NaN");
    refuses("[0.4, 2.6]", "[nan, 2.6]", "segment[1].bend[1].volts", "NaN");
    refuses("threshold_deg = 0.5\nrate_hz = 10.0", "threshold_deg = 0.5\nrate_hz = inf", "anchor.rate_hz", "inf");
}

#[test]
fn voltages_in_the_wrong_order_are_refused() {
    refuses("[0.4, 2.6]", "[2.6, 0.4]", "segment[1].bend[1].volts", "[2.6, 0.4]");
    refuses("[0.4, 2.6]", "[1.0, 1.0]", "segment[1].bend[1].volts", "[1, 1]");
}

#[test]
fn voltages_that_the_converter_cannot_read_are_refused() {
    refuses("[0.4, 2.6]", "[-0.4, 2.6]", "segment[1].bend[1].volts", "-0.4");
    refuses("[0.4, 2.6]", "[0.4, 5.0]", "segment[1].bend[1].volts", "5");
}

#[test]
fn a_map_that_turns_back_within_its_voltages_is_refused_with_the_place() {
    refuses("c1 = 0.8, c2 = 0.1", "c1 = 0.8, c2 = -0.2", "segment[1].bend[1]", "2.000 V");
}

#[test]
fn a_map_that_stays_level_is_refused() {
    refuses("c1 = 0.8, c2 = 0.1", "c1 = 0.0, c2 = 0.0", "segment[1].bend[1]", "map");
}

#[test]
fn a_map_beyond_what_fixed_point_holds_is_refused() {
    refuses("c1 = 0.8", "c1 = 80.0", "segment[1].bend[1]", "207");
}

#[test]
fn a_third_sensor_is_refused() {
    let sensor = "{ c0 = 0.0, c1 = 1.0, c2 = 0.0 }";
    refuses("bend = []", &format!("bend = [{sensor}, {sensor}, {sensor}]"), "segment[2].bend", "3");
}

#[test]
fn a_window_of_none_or_too_many_is_refused() {
    refuses("window = 100", "window = 0", "anchor.window", "0");
    refuses("window = 100", "window = 1001", "anchor.window", "1001");
}

#[test]
fn a_window_that_is_no_count_names_line_and_column() {
    refuses_at(&edited("window = 100", "window = -1"), [11, 10], "-1");
    refuses_at(&edited("window = 100", "window = 70000"), [11, 10], "70000");
}

#[test]
fn reference_headings_of_another_number_than_the_segments_are_refused() {
    refuses("[5.0, -5.0]", "[5.0]", "tare.heading_deg", "1");
    refuses("[5.0, -5.0]", "[5.0, -5.0, 0.0]", "tare.heading_deg", "3");
}

#[test]
fn variances_that_are_none_are_refused() {
    for (from, key) in [("r_imu = 0.0002", "orient.r_imu"), ("r_imu = 3e-7", "coord.r_imu")] {
        for value in ["0.0", "-1.0"] {
            refuses(from, &format!("r_imu = {value}"), &format!("segment[1].{key}"), value.trim_end_matches(".0"));
        }
    }
    refuses("r_bend = 0.002", "r_bend = 0.0", "segment[1].orient.r_bend", "0");
    refuses("q = 0.16", "q = -0.1", "segment[1].orient.q", "-0.1");
}

#[test]
fn a_measurement_of_something_else_is_refused() {
    refuses("h_imu = 1.0", "h_imu = 0.0", "segment[1].orient.h_imu", "0");
    refuses("h_bend = 1.0", "h_bend = -1.0", "segment[1].orient.h_bend", "-1");
}

#[test]
fn a_rate_of_none_is_refused() {
    refuses("rate_hz = 10.0", "rate_hz = 0.0", "rate_hz", "0");
    refuses("seconds = 1.0", "seconds = -1.0", "tare.seconds", "-1");
}

#[test]
fn a_side_that_is_none_is_refused() {
    refuses_at(&edited("\"end\"", "\"middle\""), [18, 13], "middle");
}

#[test]
fn a_missing_file_is_reported() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["none.toml", "tests"] {
        let error = ArmFile::load(&folder.join(name)).expect_err("it must be refused");
        assert!(matches!(error, FileError::Read(_)), "{name}: {error}");
    }
}

#[test]
fn the_table_that_all_these_are_made_of_is_good() {
    ArmFile::parse(TABLE).expect("else these tests show nothing");
}

#[test]
fn drift_keys_are_checked() {
    let drift = |line: &str| format!("[drift]\nkind = \"kalman\"\n{line}\n[[segment]]");
    refuses("[[segment]]", &drift("rate_deg_per_s = 0.0"), "drift.rate_deg_per_s", "0.0");
    refuses("[[segment]]", &drift("start_deg = -1.0"), "drift.start_deg", "-1.0");
    refuses("[[segment]]", &drift("offset_deg = nan"), "drift.offset_deg", "NaN");
    let kind = error("[[segment]]", "[drift]\nkind = \"average\"\n[[segment]]");
    assert!(kind.to_string().contains("average"), "{kind}");
}

#[test]
fn keys_of_contact_and_uncertainty_are_checked() {
    let keys = |section: &str, line: &str| format!("[{section}]\n{line}\n[[segment]]");
    refuses("[[segment]]", &keys("contact", "coupling_deg = 0.0"), "contact.coupling_deg", "0.0");
    let rest = "bias_share = 0.1\nbend_deg = 3.0\ncontact_deg = 1.0\nheading_deg = 0.5\nend_mm = 0.5";
    let line = format!("theta_deg = 10.0\n{rest}");
    refuses("[[segment]]", &keys("uncertainty", &line), "uncertainty.theta_deg", "10.0");
}

#[test]
fn a_segment_is_coupled_to_an_earlier_one_alone() {
    for number in [0, 1, 2] {
        let coupled = format!("length_mm = 80.0\ncoupled_to = {{ segment = {number}, ratio = 1.0 }}");
        refuses("length_mm = 80.0", &coupled, "segment[1].coupled_to.segment", &number.to_string());
    }
}

#[test]
fn limits_of_contact_are_checked() {
    let contact = "length_mm = 80.0\ncontact = { change_deg = 0.0, motion_deg = 5.0 }";
    refuses("length_mm = 80.0", contact, "segment[1].contact.change_deg", "0.0");
    let contact = "length_mm = 80.0\ncontact = { change_deg = 4.0, motion_deg = 91.0 }";
    refuses("length_mm = 80.0", contact, "segment[1].contact.motion_deg", "91.0");
}
