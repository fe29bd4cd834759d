//! Remedies of files that are nearly right: each names the way that helps, and none that leads to a wrong session.

use super::common::{Csv, Folder, arm, session, sweep, table};

/// Error and help of a replay of `session.csv`.
fn replayed(text: &str) -> (String, String) {
    let folder = Folder::with("session.csv", text);
    refused(&folder, &["replay", "session.csv", "--table", table()])
}

fn refused(folder: &Folder, command: &[&str]) -> (String, String) {
    let error = folder.refused(command);
    let stderr = folder.run(command).stderr;
    let (_, help) = stderr.split_once("  help: ").expect("an error has a help");
    (error, help.to_owned())
}

#[track_caller]
fn assert_remedy((error, help): (String, String), named: &str, remedy: &str) {
    assert!(error.contains(named), "{error}");
    assert!(help.contains(remedy), "{error}\n{help}");
}

#[test]
fn another_separator_is_named() {
    let text = session().to_string();
    let points = "write commas between the columns, and decimal points";
    assert_remedy(replayed(&text.replace(',', ";")), "between semicolons", points);
    assert_remedy(replayed(&text.replace('.', ",").replace(',', ";")), "between semicolons", points);
    assert_remedy(replayed(&text.replace(',', "\t")), "between tabs", points);
    assert_remedy(replayed(&format!("sep=;\n{}", text.replace(',', ";"))), "sep=", "remove the line");
    assert_remedy(replayed(&format!("sep=,\n{text}")), "sep=", "remove the line");
}

#[test]
fn a_name_that_is_nearly_right_is_named() {
    let renamed = |from: &str, to: &str| {
        let mut session = session();
        session.rename(from, to);
        replayed(&session.to_string())
    };
    for (name, near) in
        [("time_s", "Time_s"), ("time_s", "time_ms"), ("imu3_deg", "imu3_yaw_deg"), ("bend4b_adc", "Bend4B")]
    {
        let (error, help) = renamed(name, near);
        assert_eq!(error, format!("session.csv, line 1: column {name} is missing; did you mean {near}?"));
        assert!(help.contains(&format!("rename the column to {name}")), "{help}");
    }
    // Another sensor's column is not meant.
    let mut session = session();
    session.remove("bend4b_adc");
    let (error, help) = replayed(&session.to_string());
    assert_eq!(error, "session.csv, line 1: column bend4b_adc is missing");
    assert!(help.contains("that of a dead sensor stays, with empty cells"), "{help}");
}

#[test]
fn a_file_in_place_of_another_is_named() {
    let profile =
        "time_s,pressure1_kpa,pressure2_kpa,pressure3_kpa,pressure4_kpa,pressure5_kpa,pressure6_kpa\n0,0,0,0,0,0,0\n";
    assert_remedy(replayed(profile), "is a profile", "proprio drive");
    let mut camera = session();
    for prefix in ["bend", "imu"] {
        camera.remove(prefix);
    }
    assert_remedy(replayed(&camera.to_string()), "is a camera's", "proprio align");
    let toml = std::fs::read_to_string(table()).expect("the reference table is committed");
    assert_remedy(replayed(&toml), "arm description or a table", "--table or --arm");
    assert_remedy(replayed("<!DOCTYPE html>\n<html></html>\n"), "page for a browser", "download the file itself");
    let folder = Folder::with("session.csv", session().to_string());
    folder.done(&["replay", "session.csv", "--table", table(), "--out", "est.csv"]);
    assert_remedy(replayed(&folder.read("est.csv")), "estimates of a replay", "session that was replayed");
}

#[test]
fn a_session_in_place_of_a_profile_or_of_a_camera_s_file_is_named() {
    let mut session = session();
    session.remove("truth");
    let folder = Folder::with("session.csv", session.to_string());
    let driven = refused(&folder, &["drive", "session.csv", "--port", "/dev/no-such-port"]);
    assert_remedy(driven, "the file is a session", "pressure1_kpa, pressure2_kpa");
    let align = ["align", "session.csv", "--camera", "session.csv", "--arm", arm(), "-o", "aligned.csv"];
    assert_remedy(refused(&folder, &align), "the file is a session", "x, y and heading of each marker");
}

#[test]
fn missing_truth_is_aligned() {
    let mut sweep = sweep();
    sweep.remove("truth");
    let folder = Folder::with("sweep.csv", sweep.to_string());
    let calibrate = refused(&folder, &["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
    assert_remedy(calibrate, "the session has no truth", "`proprio align`");
}

/// A session whose times are changed from row 100 on.
fn from_row_100(time: impl Fn(f64) -> f64) -> Csv {
    let mut session = session();
    session.map("time_s", |row, cell| {
        let time_s: f64 = cell.parse().expect("a number");
        format!("{:.6}", if row < 100 { time_s } else { time(time_s) })
    });
    session
}

/// A session of a logger whose clock of 32 bits wraps at row 100.
fn wrapped(wrap_s: f64) -> Csv {
    let mut session = session();
    session.map("time_s", |_, cell| {
        let time_s: f64 = cell.parse().expect("a number");
        format!("{:.6}", (time_s + wrap_s - 10.0).rem_euclid(wrap_s))
    });
    session
}

#[test]
fn time_that_goes_backwards_has_the_remedy_of_its_reason() {
    for (wrap_s, remedy) in [(4_294.967_296, "add 4294.967296 s"), (4_294_967.296, "add 4294967.296 s")] {
        let (error, help) = replayed(&wrapped(wrap_s).to_string());
        assert!(error.starts_with("session.csv, line 102, column time_s: time goes backwards"), "{error}");
        assert!(help.contains(remedy) && help.contains("do not sort"), "{help}");
    }
    // The board has restarted at 500 s and begins at 0.
    let mut restarted = from_row_100(|time_s| time_s - 10.0);
    restarted.map(
        "time_s",
        |row, cell| if row < 100 { format!("{:.1}", 490.0 + row as f64 / 10.0) } else { cell.to_owned() },
    );
    assert_remedy(replayed(&restarted.to_string()), "from 499.9 s to 0 s", "restarted: split the session here");
    // Two rows in the other order.
    let mut session = session();
    session.rows.swap(99, 100);
    assert_remedy(replayed(&session.to_string()), "from 10 s to 9.9 s", "sort them by time");
    // Neither near zero, nor a small step.
    let mut set = from_row_100(|time_s| time_s + 5000.0);
    set.map(
        "time_s",
        |row, cell| if row < 100 { format!("{:.1}", 9000.0 + row as f64 / 10.0) } else { cell.to_owned() },
    );
    let (_, help) = replayed(&set.to_string());
    assert!(help.contains("split it here; do not sort"), "{help}");
}

/// Error and help of a check of a file with these bytes.
fn checked(name: &str, bytes: &[u8]) -> (String, String) {
    let folder = Folder::with(name, bytes);
    refused(&folder, &["check", name, "--table", table()])
}

#[test]
fn packed_files_and_those_of_other_programs_are_named() {
    let padded = |begin: &[u8]| [begin, &[0xa5; 200]].concat();
    assert_remedy(checked("session.csv.gz", &padded(b"\x1f\x8b\x08\0")), "is a packed file (gzip)", "unpack it first");
    // By the content, not by the name.
    assert_remedy(checked("session.csv", &padded(b"PK\x03\x04")), "is a packed file (zip)", "unpack it first");
    assert_remedy(checked("session.xlsx", &padded(b"PK\x03\x04")), "is a spreadsheet", "save it as CSV in UTF-8");
    assert_remedy(
        checked("session.db3", &padded(b"SQLite format 3\0")),
        "bags of ROS 2",
        "write its readings to a CSV",
    );
    let folder = Folder::with("session.mcap.gz", padded(b"\x1f\x8b\x08\0"));
    let recover = ["recover", "session.mcap.gz", "-o", "whole.mcap"];
    assert_remedy(refused(&folder, &recover), "is a packed file (gzip)", "unpack it first");
}

#[test]
fn text_in_utf_16_is_named_with_and_without_its_mark() {
    let text = session().to_string();
    let units = |to: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(to).collect::<Vec<u8>>();
    let (little, big) = (units(u16::to_le_bytes), units(u16::to_be_bytes));
    let marked = [&[0xff, 0xfe], &little[..]].concat();
    for bytes in [little, big, marked] {
        assert_remedy(checked("session.csv", &bytes), "is text in UTF-16", "save it as UTF-8");
    }
    // The mark of UTF-8 is read over.
    let folder = Folder::with("session.csv", format!("\u{feff}{text}"));
    folder.done(&["check", "session.csv", "--table", table()]);
}

#[test]
fn a_recording_in_place_of_a_camera_s_file_is_named() {
    let mut session = session();
    session.remove("truth");
    let folder = Folder::with("session.csv", session.to_string());
    folder.done(&["convert", "session.csv", "session.mcap"]);
    let align = ["align", "session.csv", "--camera", "session.mcap", "--arm", arm(), "-o", "aligned.csv"];
    assert_remedy(refused(&folder, &align), "is a recording, expected a CSV", "`proprio convert`");
}
