//! `[board]`: accepted and rejected wirings, and their form in a written file.

use calibration_tables::{AnalogPin, ArmFile, BoardSegmentToml, BoardToml, DigitalPin, ImuToml, RegulatorToml};
use proptest::option;
use proptest::prelude::*;

use super::common::{DESCRIPTION, TABLE, parse};

/// A wiring of the two segments of [`TABLE`], a line each.
const BOARD: &str = r#"
[board]
[[board.segment]]
bend = ["A0", "A11"]
imu = { channel = 0, address = 0x28 }
[[board.segment]]
bend = ["A4"]
imu = { channel = 0, address = 0x29 }
[[board.regulator]]
pin = "D6"
full_scale_kpa = 280
[[board.regulator]]
pin = "D40"
full_scale_kpa = 100.5
"#;

/// [`TABLE`] with the wiring, and another text in one place of it.
fn wired(from: &str, to: &str) -> String {
    assert!(BOARD.contains(from), "{from} is not in the wiring");
    format!("{TABLE}{}", BOARD.replacen(from, to, 1))
}

/// Asserts that the error begins with the line of the edited text and with `start`, and contains `expected`.
fn refuses(from: &str, to: &str, start: &str, expected: &str) {
    let text = wired(from, to);
    let error = ArmFile::parse(&text).expect_err("it must be refused").to_string();
    let (line, rest) = error.strip_prefix("line ").and_then(|error| error.split_once(": ")).expect("the line");
    let edited = to.lines().next().unwrap_or_default();
    let number: usize = line.parse().expect("a number");
    assert!(text.lines().nth(number - 1).is_some_and(|line| line.contains(edited)), "{error}");
    assert!(rest.starts_with(start) && rest.contains(expected), "{error}");
}

#[test]
fn every_key_of_a_wiring_is_read() {
    let board = parse(&wired("", "")).board.expect("the section is there");
    let imu = |address| Some(ImuToml { channel: 0, address });
    let segments = vec![
        BoardSegmentToml { bend: vec![AnalogPin(0), AnalogPin(11)], imu: imu(0x28) },
        BoardSegmentToml { bend: vec![AnalogPin(4)], imu: imu(0x29) },
    ];
    let regulators = vec![
        RegulatorToml { pin: DigitalPin(6), full_scale_kpa: 280.0 },
        RegulatorToml { pin: DigitalPin(40), full_scale_kpa: 100.5 },
    ];
    assert_eq!(board, BoardToml { segments, regulators });
}

#[test]
fn a_file_without_the_section_has_no_wiring() {
    assert_eq!((parse(TABLE).board, parse(DESCRIPTION).board), (None, None));
}

#[test]
fn a_segment_without_sensors_and_an_arm_without_regulators_are_read() {
    let board = parse(&format!("{DESCRIPTION}[board]\n[[board.segment]]\n")).board.expect("the section is there");
    assert_eq!(board.segments, [BoardSegmentToml { bend: Vec::new(), imu: None }]);
    assert!(board.regulators.is_empty());
}

#[test]
fn more_pins_than_maps_are_read() {
    // The second segment of the table has no map and one pin.
    assert_eq!(parse(&wired("", "")).bend_sensors().expect("it is a table"), [1, 0]);
}

#[test]
fn fewer_pins_than_maps_are_refused() {
    refuses(r#"bend = ["A0", "A11"]"#, "bend = []", "board.segment[1].bend = 0 pins", "expected 1");
}

#[test]
fn another_number_of_segments_is_refused() {
    let more = wired("[[board.regulator]]", "[[board.segment]]\n[[board.regulator]]");
    let error = ArmFile::parse(&more).expect_err("it must be refused").to_string();
    assert!(error.contains("board.segment = 3 segments, expected 2"), "{error}");
    let none = format!("{DESCRIPTION}[board]\n");
    let error = ArmFile::parse(&none).expect_err("it must be refused").to_string();
    assert!(error.contains("board.segment = 0 segments, expected 1"), "{error}");
}

#[test]
fn an_analog_pin_that_the_board_does_not_have_is_refused() {
    refuses(r#"["A4"]"#, r#"["A12"]"#, "board.segment[2].bend = pin A12", "A0 to A11");
}

#[test]
fn a_third_bend_sensor_on_a_segment_is_refused() {
    refuses(r#"["A0", "A11"]"#, r#"["A0", "A1", "A2"]"#, "board.segment[1].bend = 3 pins", "at most two");
}

#[test]
fn a_pin_in_use_is_refused_with_the_key_that_has_it() {
    refuses(r#"["A4"]"#, r#"["A11"]"#, "board.segment[2].bend = pin A11", "board.segment[1].bend has this one");
    refuses("\"D40\"", "\"D6\"", "board.regulator[2].pin = D6", "board.regulator[1].pin has this one");
}

#[test]
fn an_imu_in_a_place_in_use_is_refused() {
    refuses("0x29", "0x28", "board.segment[2].imu = channel 0, address 0x28", "board.segment[1].imu has this one");
}

#[test]
fn a_channel_or_an_address_that_no_imu_has_is_refused() {
    refuses("channel = 0, address = 0x29", "channel = 8, address = 0x29", "board.segment[2].imu.channel = 8", "0 to 7");
    refuses("0x29", "0x2a", "board.segment[2].imu.address = 0x2a", "0x28 or 0x29");
}

#[test]
fn a_regulator_on_a_pin_without_pwm_is_refused() {
    refuses("\"D40\"", "\"D10\"", "board.regulator[2].pin = D10", "D6, D7, D8, D9, D34, D36, D38, D40");
}

#[test]
fn a_full_scale_of_nothing_or_over_1_mpa_is_refused() {
    for value in ["0", "-1", "1000.1", "nan"] {
        let to = format!("full_scale_kpa = {value}");
        refuses("full_scale_kpa = 280", &to, "board.regulator[1].full_scale_kpa", "0.001 to 1000.0");
    }
}

#[test]
fn nine_regulators_are_refused() {
    let regulator = "[[board.regulator]]\npin = \"D6\"\nfull_scale_kpa = 280\n";
    let text = format!("{DESCRIPTION}[board]\n[[board.segment]]\n{}", regulator.repeat(9));
    let error = ArmFile::parse(&text).expect_err("it must be refused").to_string();
    assert!(error.contains("board.regulator = 9 regulators, expected at most 8"), "{error}");
}

#[test]
fn a_name_that_is_no_pin_is_refused_with_its_line() {
    for name in ["4", "B4", "A", "A04", "A+4", "a4", "A256"] {
        let to = format!("[\"{name}\"]");
        let text = wired(r#"["A4"]"#, &to);
        let error = ArmFile::parse(&text).expect_err("it must be refused").to_string();
        let line = 1 + text.lines().position(|line| line.contains(&to)).expect("the edited line");
        assert!(error.starts_with(&format!("line {line}, ")) && error.contains("analog pin such as"), "{error}");
    }
    let error = ArmFile::parse(&wired("\"D6\"", "\"6\"")).expect_err("it must be refused").to_string();
    assert!(error.contains("digital pin such as"), "{error}");
}

#[test]
fn an_unknown_key_of_a_wiring_is_named() {
    for (from, to) in [("bend = [\"A4\"]", "bends = [\"A4\"]"), ("full_scale_kpa = 280", "full_scale_pa = 280")] {
        let error = ArmFile::parse(&wired(from, to)).expect_err("it must be refused").to_string();
        let key = to.split(' ').next().expect("a key");
        assert!(error.contains(&format!("`{key}`")), "{error}");
    }
}

/// Nine segments are more than the board has room for; a host replays their sessions all the same.
#[test]
fn an_arm_of_more_segments_than_the_board_has_room_for_is_read() {
    let (head, segment) = DESCRIPTION.split_once("[[segment]]").expect("it has a segment");
    let arm = format!("{head}{}", format!("[[segment]]{segment}").repeat(9));
    assert_eq!(parse(&arm).segments.len(), 9);
    let board = parse(&format!("{arm}[board]\n{}", "[[board.segment]]\n".repeat(9))).board;
    assert_eq!(board.map(|board| board.segments.len()), Some(9));
}

#[test]
fn a_written_wiring_has_a_table_a_segment_and_hexadecimal_addresses() {
    let text = parse(&wired("", "")).to_toml();
    let lines = [
        "[board]",
        "[[board.segment]]",
        r#"bend = ["A0", "A11"]"#,
        "imu = { channel = 0, address = 0x28 }",
        "[[board.regulator]]",
        r#"pin = "D6""#,
        "full_scale_kpa = 280.0",
    ];
    for line in lines {
        assert!(text.lines().any(|found| found == line), "{line} is not in {text}");
    }
}

/// Wirings of two segments: two bend sensors, one or none on each, with or without an IMU; 0 to 8 regulators.
fn board() -> impl Strategy<Value = BoardToml> {
    let pins = Just((0..12).map(AnalogPin).collect::<Vec<_>>()).prop_shuffle();
    let imus = [option::of(Just(0x28_u8)), option::of(Just(0x29_u8))];
    let outputs = Just([6, 7, 8, 9, 34, 36, 38, 40]).prop_shuffle();
    let full_scales = prop::collection::vec(0.001..=1000.0_f64, 0..=8);
    (pins, [1..=2_usize, 0..=2], imus, 0..8_u8, outputs, full_scales).prop_map(
        |(pins, [first, second], imus, channel, outputs, full_scales)| {
            let bends = [pins[..first].to_vec(), pins[first..first + second].to_vec()];
            let imus = imus.map(|address| address.map(|address| ImuToml { channel, address }));
            let segments = bends.into_iter().zip(imus).map(|(bend, imu)| BoardSegmentToml { bend, imu }).collect();
            let regulators = outputs
                .into_iter()
                .zip(full_scales)
                .map(|(pin, full_scale_kpa)| RegulatorToml { pin: DigitalPin(pin), full_scale_kpa })
                .collect();
            BoardToml { segments, regulators }
        },
    )
}

/// A file that was cut short in a copy would otherwise be that of a shorter arm, or of one with the reference wiring.
#[test]
fn a_written_table_that_lost_a_segment_is_refused() {
    let text = parse(&format!("{TABLE}{BOARD}")).to_toml();
    let starts: Vec<usize> = text.match_indices("[[segment]]").map(|(start, _)| start).collect();
    assert_eq!(starts.len(), 2);
    for start in starts {
        let error = ArmFile::parse(&text[..start]).expect_err("it must be refused").to_string();
        assert!(error.contains("segment"), "{error}");
    }
}

proptest! {
    #[test]
    fn a_written_wiring_is_read_as_it_was(board in board()) {
        let file = ArmFile { board: Some(board), ..parse(TABLE) };
        let text = file.to_toml();
        let read = ArmFile::parse(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        prop_assert_eq!(read, file);
    }
}
