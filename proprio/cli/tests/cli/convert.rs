//! `proprio convert`: values that are kept to the bit, and notes about those that are left out.

use super::board::SyntheticBoard;
use super::common::{Folder, Run, estimates, quaternion_session, session, table};
use super::recording_files::{record, recorded};

fn with_recording() -> (Folder, Vec<u8>) {
    let bytes: Vec<Vec<u8>> = SyntheticBoard::new(1, 12.0).map(|(frames, _)| frames.concat()).collect();
    (Folder::with("a.mcap", record(bytes.clone())), bytes.concat())
}

fn convert(folder: &Folder, from: &str, to: &str) -> Run {
    folder.done(&["convert", from, to])
}

#[test]
fn the_bytes_of_a_recording_are_those_that_came() {
    let (folder, bytes) = with_recording();
    let run = convert(&folder, "a.mcap", "a.bin");
    assert!(std::fs::read(folder.path("a.bin")).expect("it was written") == bytes);
    assert!(run.stderr.contains("times of arrival"), "{}", run.stderr);
}

#[test]
fn raw_bytes_become_a_recording_that_replays_bit_for_bit() {
    let (folder, _) = with_recording();
    convert(&folder, "a.mcap", "a.bin");
    convert(&folder, "a.bin", "b.mcap");
    assert_eq!(recorded(&folder, "b.mcap"), {
        let (recorded, stderr) = recorded(&folder, "a.mcap");
        (recorded, stderr.replace("a.mcap", "b.mcap"))
    });
    convert(&folder, "b.mcap", "b.bin");
    let [a, b] = ["a.bin", "b.bin"].map(|name| std::fs::read(folder.path(name)).expect("it was written"));
    assert!(a == b);
}

#[test]
fn a_csv_of_a_board_goes_to_a_recording_and_back_to_the_byte() {
    let (folder, _) = with_recording();
    convert(&folder, "a.mcap", "a.csv");
    convert(&folder, "a.csv", "b.mcap");
    convert(&folder, "b.mcap", "b.csv");
    assert_eq!(folder.read("a.csv"), folder.read("b.csv"));
}

#[test]
fn truth_goes_with_the_samples_and_the_figures_stay_the_same() {
    let folder = Folder::with("a.csv", quaternion_session().to_string());
    let run = convert(&folder, "a.csv", "a.mcap");
    assert!(!run.stderr.contains("rounded"), "{}", run.stderr);
    let figures = |name: &str| {
        let run = folder.done(&["replay", name, "--table", table(), "--json", "--force", "--out", "est.csv"]);
        (super::common::json(&run)["all"].clone(), folder.read("est.csv"))
    };
    let expected = figures("a.csv");
    assert!(expected.0["methods"]["fusion"]["tip_rmse_mm"].is_number());
    assert_eq!(figures("a.mcap"), expected);
    convert(&folder, "a.mcap", "b.csv");
    assert_eq!(figures("b.csv"), expected);
}

#[test]
fn headings_become_quaternions_with_a_note() {
    let folder = Folder::with("a.csv", session().to_string());
    let run = convert(&folder, "a.csv", "a.mcap");
    assert!(run.stderr.contains("headings became quaternions"), "{}", run.stderr);
    convert(&folder, "a.mcap", "b.csv");
    let (exact, rounded) = (estimates(session()), estimates(folder.read("b.csv")));
    for (exact, rounded) in exact.numbers("bend1_theta_deg").iter().zip(rounded.numbers("bend1_theta_deg")) {
        assert!((exact - rounded).abs() < 1e-9);
    }
    let last =
        |of: &super::common::Csv| of.cell(of.rows.len() - 1, "imu_o3_theta_deg").parse::<f64>().expect("a number");
    let difference_deg = (last(&exact) - last(&rounded)).abs();
    assert!(difference_deg < 0.03, "{difference_deg}");
}

#[test]
fn columns_that_are_none_of_a_sessions_are_named() {
    let mut with_note = quaternion_session();
    with_note.push("note", "x");
    let folder = Folder::with("a.csv", with_note.to_string());
    let run = convert(&folder, "a.csv", "a.mcap");
    assert!(run.stderr.contains("the columns note are left out"), "{}", run.stderr);
}

#[test]
fn a_session_keeps_the_tares_of_the_arm() {
    let mut tared = quaternion_session();
    tared.push("tare", "0");
    for row in 75..150 {
        tared.set(row, "tare", "1");
    }
    let mut second = quaternion_session();
    second.rows.drain(..75);
    let of_both = estimates(&tared);
    assert_eq!(of_both.rows[75..], estimates(&second).rows[..]);
    tared.set(80, "tare", "one");
    let error = Folder::with("a.csv", tared.to_string()).refused(&["replay", "a.csv", "--table", table()]);
    assert!(error.contains("line 82, column tare: tare one"), "{error}");
}

#[test]
fn what_cannot_be_converted_is_refused() {
    let folder = Folder::with("a.csv", session().to_string());
    assert!(folder.refused(&["convert", "a.csv", "b.csv"]).contains("of this kind already"));
    assert!(folder.refused(&["convert", "a.csv", "b.txt"]).contains("ends with none of .csv"));
    assert!(folder.refused(&["convert", "none.csv", "b.mcap"]).contains("cannot be read"));
    let mut nine = session();
    for segment in [7, 8, 9] {
        for column in ["imuK_deg", "truthK_x_mm", "truthK_y_mm", "truthK_heading_deg"] {
            nine.push(&column.replace('K', &segment.to_string()), "0");
        }
    }
    folder.write("nine.csv", nine.to_string());
    assert!(
        folder
            .refused(&["convert", "nine.csv", "b.mcap"])
            .contains("has 9 segments, a board and its recordings have 8 at most")
    );
}
