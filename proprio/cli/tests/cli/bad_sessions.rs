//! Files that are no session of this arm at all: each refused with its name, its line where there is one, and the
//! column where one is missing or too many.

use super::common::{Csv, Folder, arm, session, table};

fn refused(contents: impl AsRef<[u8]>) -> String {
    let folder = Folder::with("session.csv", contents);
    folder.refused(&["replay", "session.csv", "--table", table(), "--out", "est.csv"])
}

/// The error of a session whose header is wrong, which must name the file, the first line and `column`.
fn refuses_column(column: &str, edit: impl FnOnce(&mut Csv)) {
    let mut session = session();
    edit(&mut session);
    let error = refused(session.to_string());
    assert!(error.starts_with("session.csv, line 1: ") && error.contains(column), "{error}");
}

fn refused_with_table(edit: impl FnOnce(&str) -> String) -> String {
    let folder = Folder::with("session.csv", session().to_string());
    let reference = std::fs::read_to_string(table()).expect("the reference table is committed");
    folder.write("table.toml", edit(&reference));
    folder.refused(&["replay", "session.csv", "--table", "table.toml", "--out", "est.csv"])
}

#[test]
fn a_file_cut_in_the_middle_of_a_row_is_refused() {
    let text = session().to_string();
    let cut = text.len() - 100;
    let error = refused(&text[..cut]);
    let line = text[..cut].lines().count();
    assert!(error.starts_with(&format!("session.csv, line {line}: ")), "{error}");
}

#[test]
fn a_row_with_too_many_cells_is_refused() {
    let mut session = session();
    session.rows[120].push("1".to_owned());
    assert!(refused(session.to_string()).starts_with("session.csv, line 122: "));
}

#[test]
fn a_missing_bend_sensor_is_named() {
    refuses_column("bend4b_adc", |session| session.remove("bend4b_adc"));
}

#[test]
fn a_missing_imu_is_named() {
    refuses_column("imu6_deg", |session| session.remove("imu6_deg"));
}

#[test]
fn a_missing_time_is_named() {
    refuses_column("time_s", |session| session.remove("time_s"));
}

#[test]
fn a_missing_part_of_the_truth_is_named() {
    refuses_column("truth5_y_mm", |session| session.remove("truth5_y_mm"));
}

#[test]
fn a_heading_without_its_place_is_named() {
    refuses_column("truth1_x_mm", |session| {
        session.remove("truth1_x_mm");
        session.remove("truth1_y_mm");
    });
}

#[test]
fn a_place_of_which_a_part_is_missing_is_named() {
    refuses_column("truth5_x_mm", |session| {
        (1..=6).for_each(|i| session.remove(&format!("truth{i}_heading")));
        session.remove("truth5_x_mm");
    });
}

#[test]
fn a_missing_part_of_a_quaternion_is_named() {
    refuses_column("imu3_qy", |session| {
        session.rename("imu3_deg", "imu3_qw");
        session.push("imu3_qx", "0");
        session.push("imu3_qz", "0");
    });
}

#[test]
fn a_column_that_is_there_twice_is_named() {
    refuses_column("imu2_deg", |session| session.push("imu2_deg", "1"));
    refuses_column("time_s", |session| session.push("time_s", "1"));
}

#[test]
fn the_table_of_a_longer_arm_is_refused() {
    let error = refused_with_table(|table| {
        let segment = table.rfind("[[segment]]").expect("the table has segments");
        format!("{table}\n{}", &table[segment..])
    });
    assert!(error.starts_with("session.csv, line 1: ") && error.contains("bend7a_adc"), "{error}");
}

#[test]
fn the_table_of_a_shorter_arm_is_refused() {
    let error = refused_with_table(|table| {
        let segment = table.rfind("[[segment]]").expect("the table has segments");
        table[..segment].to_owned()
    });
    assert!(error.starts_with("session.csv, line 1: "), "{error}");
    assert!(error.contains("segment 6") && error.contains('5'), "{error}");
}

#[test]
fn an_arm_description_is_no_table() {
    let folder = Folder::with("session.csv", session().to_string());
    let error = folder.refused(&["replay", "session.csv", "--table", arm(), "--out", "est.csv"]);
    assert!(error.starts_with(arm()) && error.contains("arm description"), "{error}");
}

#[test]
fn a_broken_table_is_refused_with_its_line_and_column() {
    let error = refused_with_table(|table| table.replacen("rate_hz = 10.0", "rate_hz = ten", 1));
    assert!(error.starts_with("table.toml: ") && error.contains("line 3, column 11"), "{error}");
}

#[test]
fn a_table_that_is_not_there_is_named() {
    let folder = Folder::with("session.csv", session().to_string());
    let error = folder.refused(&["replay", "session.csv", "--table", "none.toml", "--out", "est.csv"]);
    assert!(error.starts_with("none.toml: "), "{error}");
}

#[test]
fn an_empty_file_is_refused() {
    assert!(refused("").starts_with("session.csv: is empty"));
    assert!(refused("\n\n").starts_with("session.csv: is empty"));
}

#[test]
fn a_header_without_rows_is_refused() {
    let mut session = session();
    session.rows.clear();
    assert!(refused(session.to_string()).starts_with("session.csv: has no samples"));
}

#[test]
fn bytes_that_are_not_utf8_are_refused_with_their_line() {
    let mut bytes = session().to_string().into_bytes();
    let row = bytes.split(|byte| *byte == b'\n').take(121).map(|line| line.len() + 1).sum::<usize>();
    bytes[row + 4] = 0xff;
    assert_eq!(refused(bytes), "session.csv, line 122: is not UTF-8 text");
}

#[test]
fn a_header_that_is_not_utf8_is_refused() {
    let mut bytes = session().to_string().into_bytes();
    bytes[8] = 0xfc;
    assert_eq!(refused(bytes), "session.csv, line 1: is not UTF-8 text");
}

#[test]
fn a_quote_that_never_ends_is_refused() {
    let mut session = session();
    session.set(120, "bend1a_adc", "\"2000");
    assert!(refused(session.to_string()).starts_with("session.csv, line 122"));
}

#[test]
fn a_file_with_semicolons_is_refused() {
    let error = refused(session().to_string().replace(',', ";"));
    assert!(error.starts_with("session.csv, line 1: "), "{error}");
}

#[test]
fn a_directory_is_refused() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("session.csv")).expect("a temporary folder can be written to");
    let error = folder.refused(&["replay", "session.csv", "--table", table(), "--out", "est.csv"]);
    assert!(error.starts_with("session.csv: is a directory"), "{error}");
}

#[test]
fn a_file_that_is_not_there_is_refused() {
    let error = Folder::new().refused(&["replay", "none.csv", "--table", table(), "--out", "est.csv"]);
    assert!(error.starts_with("none.csv: cannot be read"), "{error}");
}

#[test]
fn a_path_below_a_file_is_refused() {
    let folder = Folder::with("session.csv", session().to_string());
    let error = folder.refused(&["replay", "session.csv/more.csv", "--table", table(), "--out", "est.csv"]);
    assert!(error.starts_with("session.csv/more.csv: cannot be read"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_read_is_refused() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::with("session.csv", session().to_string());
    let path = folder.path("session.csv");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).expect("the file is ours");
    if std::fs::read(&path).is_ok() {
        println!("skipped: root may read everything; see `a_path_below_a_file_is_refused`");
        return;
    }
    let error = folder.refused(&["replay", "session.csv", "--table", table(), "--out", "est.csv"]);
    assert!(error.starts_with("session.csv: cannot be read"), "{error}");
}
