//! The section `[board]`: kept by `calibrate` and `tune`, stored on a board by `table push`, and refused there where it does
//! not fit.

use calibration_tables::ArmFile;

use super::common::{Folder, arm, sweep, table};
use super::tune::{TUNE, load, training};

/// A file of the reference arm with a wiring that is not the reference wiring.
fn wired(path: &str) -> ArmFile {
    let file = load(path);
    let pins = [(11, 10), (9, 8), (7, 6), (5, 4), (3, 2), (1, 0)];
    let segment = |(channel, (a, b)): (usize, &(u8, u8))| {
        let imu = format!("imu = {{ channel = {}, address = 0x29 }}", 7 - channel);
        format!("[[board.segment]]\nbend = [\"A{a}\", \"A{b}\"]\n{imu}\n")
    };
    let segments = pins.iter().enumerate().map(segment).collect::<Vec<_>>().concat();
    let regulator = "[[board.regulator]]\npin = \"D40\"\nfull_scale_kpa = 150\n";
    let text = format!("{}\n[board]\n{segments}{regulator}", file.to_toml());
    ArmFile::parse(&text).expect("the wiring is valid")
}

#[test]
fn a_calibration_keeps_the_wiring_of_the_description() {
    let description = wired(arm());
    let folder = Folder::with("sweep.csv", sweep().to_string());
    folder.write("arm.toml", description.to_toml());
    folder.done(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "table.toml"]);
    let made = load(folder.path("table.toml"));
    assert!(made.board.is_some() && made.board == description.board);
}

#[test]
fn a_tuning_keeps_the_wiring_of_the_table() {
    let mut before = wired(table());
    (before.drift, before.uncertainty) = (None, None);
    let folder = Folder::with("session.csv", training().to_string());
    folder.write("table.toml", before.to_toml());
    folder.done(&TUNE);
    let tuned = load(folder.path("tuned.toml"));
    assert!(tuned.board.is_some() && tuned.board == before.board);
}

/// Error and help of a push of the reference table after a change; no line is opened.
fn push_refused(change: impl FnOnce(&mut ArmFile)) -> String {
    let mut file = load(table());
    change(&mut file);
    let folder = Folder::with("large.toml", file.to_toml());
    let error = folder.refused(&["table", "push", "large.toml", "--port", "/dev/no-such-port"]);
    // The same by `check`, which has no board at hand.
    assert_eq!(folder.refused(&["check", "large.toml"]), error);
    error
}

#[test]
fn a_table_of_more_segments_than_the_board_has_room_for_is_not_pushed() {
    let error = push_refused(|file| file.segments.extend_from_within(3..));
    assert_eq!(error, "large.toml: the arm has 9 segments, and the board has room for 8");
}

#[test]
fn a_table_of_more_bend_sensors_than_the_board_has_pins_is_not_pushed() {
    let error = push_refused(|file| {
        file.segments.extend_from_within(5..);
        file.segments[6].bend.as_mut().expect("it is a table").truncate(1);
    });
    assert_eq!(error, "large.toml: the arm has 13 bend sensors, and the board has 12 analog pins");
}

/// Such tables are for a host alone.
#[test]
fn a_table_that_does_not_fit_the_board_is_a_table_for_the_host() {
    let mut file = load(table());
    file.segments.extend_from_within(3..);
    let read = ArmFile::parse(&file.to_toml()).expect("a valid table");
    assert_eq!(read.bend_sensors().expect("it is a table"), [2; 9]);
}

/// The board needs the wiring to send the samples of a calibration.
#[test]
fn an_arm_description_can_be_pushed() {
    let folder = Folder::with("arm.toml", wired(arm()).to_toml());
    let error = folder.refused(&["table", "push", "arm.toml", "--port", "/dev/no-such-port"]);
    assert!(error.contains("/dev/no-such-port"), "only the port is wrong: {error}");
}
