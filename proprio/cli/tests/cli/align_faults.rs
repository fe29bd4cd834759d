//! Recordings that do not fit together, or cannot be used: each refused with one error, and nothing written.

use super::common::{Csv, Folder, arm, session};
use super::recordings::{Recording, args};

fn refused(edit: impl FnOnce(&mut Recording)) -> String {
    let mut recording = Recording::short();
    edit(&mut recording);
    recording.refused()
}

/// Negates a column, empty cells aside.
fn negate(csv: &mut Csv, name: &str) {
    csv.map(name, |_, text| text.parse::<f64>().map_or(String::new(), |value| (-value).to_string()));
}

#[test]
fn another_runs_camera_has_no_motion_in_common() {
    let other = Recording::simulate("--scenario 2 --seconds 300 --seed 76");
    let error = refused(|recording| recording.camera = other.camera);
    assert!(error.starts_with("camera.csv: has no motion in common with the session"), "{error}");
}

#[test]
fn recordings_one_after_the_other_are_refused() {
    let mut recording = Recording::long();
    recording.keep_samples(|time_s| time_s < 400.0);
    recording.keep_frames(|time_s| time_s > 450.0);
    let error = recording.refused();
    assert!(error.starts_with("camera.csv: has no motion in common"), "{error}");
}

#[test]
fn an_overlap_of_less_than_a_minute_is_refused() {
    let mut recording = Recording::long();
    recording.keep_samples(|time_s| time_s < 450.0);
    recording.keep_frames(|time_s| time_s > 410.0);
    let error = recording.refused();
    assert!(error.starts_with("camera.csv: has no motion in common"), "{error}");
}

#[test]
fn a_motion_that_repeats_itself_is_ambiguous() {
    let mut recording = Recording::short();
    // The same 50 s six times; the seams are at rest.
    let (from, length) = (100.0, 50.0);
    let repeat = |csv: &Csv, seconds: &dyn Fn(&str) -> f64| {
        let time = csv.column("time_s");
        let mut repeated = Csv { names: csv.names.clone(), rows: Vec::new() };
        for round in 0..6 {
            for row in &csv.rows {
                let time_s = seconds(&row[time]);
                if (from..from + length).contains(&time_s) {
                    let mut row = row.clone();
                    row[time] = format!("{:.6}", time_s - from + f64::from(round) * length);
                    repeated.rows.push(row);
                }
            }
        }
        repeated
    };
    recording.retime(|time_s| time_s);
    recording.session = repeat(&recording.session, &|text| text.parse().expect("a time"));
    recording.camera = repeat(&recording.camera, &|text| text.parse().expect("a time"));
    let error = recording.refused();
    assert!(error.starts_with("camera.csv: two offsets, 50.0 s apart, fit nearly alike"), "{error}");
}

#[test]
fn headings_that_are_not_clockwise_are_named() {
    let error = refused(|recording| {
        for i in 1..=6 {
            negate(&mut recording.camera, &format!("truth{i}_heading_deg"));
        }
        negate(&mut recording.camera, "base_heading_deg");
    });
    assert!(error.contains("headings fall where the IMUs' rise"), "{error}");
}

#[test]
fn a_camera_whose_clock_jumped_is_refused() {
    let error = refused(|recording| recording.retime(|time_s| if time_s < 150.0 { time_s } else { time_s + 0.3 }));
    assert!(error.contains("clocks do not run evenly"), "{error}");
}

/// Frame numbers over 30 are no times where frames were dropped: 3 % are 30 000 ppm.
#[test]
fn times_that_were_counted_from_frames_are_refused() {
    let error = refused(|recording| recording.camera.map("time_s", |row, _| format!("{:.6}", row as f64 / 30.0)));
    assert!(error.starts_with("camera.csv: "), "{error}");
    assert!(!error.contains("expected a"), "{error}");
}

#[test]
fn clocks_of_rates_too_different_are_refused() {
    let error = Recording::short().with_clock(0.0, 4000.0).refused();
    assert!(error.contains("rates differ by 40") || error.contains("rates differ by 39"), "{error}");
}

#[test]
fn recordings_of_less_than_a_minute_are_refused_by_name() {
    let error = refused(|recording| recording.keep_samples(|time_s| time_s < 50.05));
    assert!(error.starts_with("session.csv: the recording lasts 50.0 s"), "{error}");
    let error = refused(|recording| recording.keep_frames(|time_s| time_s < 50.0));
    assert!(error.starts_with("camera.csv: the recording lasts 50.0 s"), "{error}");
}

/// A first frame that was stamped before the clock was set.
#[test]
fn a_time_stamp_that_makes_the_recording_years_long_is_refused() {
    let error = refused(|recording| recording.camera.set(0, "time_s", "12"));
    assert_eq!(error, "camera.csv: the recording lasts 488889 h by its time stamps, expected at most 24");
    let error = refused(|recording| recording.session.set(2999, "time_s", "1e6"));
    assert_eq!(error, "session.csv: the recording lasts 278 h by its time stamps, expected at most 24");
}

#[test]
fn an_arm_at_rest_is_refused() {
    let error = refused(|recording| {
        for i in 1..=6 {
            recording.session.map(&format!("imu{i}_deg"), |_, _| "10".to_owned());
        }
    });
    assert_eq!(error, "camera.csv: the arm hardly moves where both saw it without a pause");
}

#[test]
fn markers_that_are_hidden_most_of_the_time_are_refused() {
    let error = refused(|recording| {
        // 4.5 s in sight, half a second hidden: a step takes four seconds.
        recording.keep_frames(|time_s| time_s % 5.0 < 4.5);
    });
    assert!(error.starts_with("camera.csv: shares less than 60 s with the session at any offset"), "{error}");
}

#[test]
fn a_session_without_any_reading_is_refused() {
    let error = refused(|recording| {
        for name in recording.session.names.clone() {
            if name != "time_s" {
                recording.session.map(&name, |_, _| String::new());
            }
        }
    });
    assert_eq!(error, "session.csv: has no reading of any IMU or bend sensor");
}

#[test]
fn a_camera_that_saw_no_marker_is_refused() {
    let error = refused(|recording| {
        for name in recording.camera.names.clone() {
            if name.starts_with("truth") {
                recording.camera.map(&name, |_, _| String::new());
            }
        }
    });
    assert_eq!(error, "camera.csv: the camera saw no marker of a segment");
}

#[test]
fn a_base_that_was_never_seen_is_refused() {
    let error = refused(|recording| {
        for part in ["x_mm", "y_mm", "heading_deg"] {
            recording.camera.map(&format!("base_{part}"), |_, _| String::new());
        }
    });
    assert_eq!(error, "camera.csv: the camera never saw the base's marker");
}

#[test]
fn a_camera_that_was_moved_is_refused() {
    let error = refused(|recording| {
        recording.camera.map("base_x_mm", |row, text| match text.parse::<f64>() {
            Ok(x_mm) if row > 6000 => (x_mm + 20.0).to_string(),
            _ => text.to_owned(),
        });
    });
    // From the median, which lies among the frames before.
    let is = |mm| error.starts_with(&format!("camera.csv: the base's marker moved by {mm} mm"));
    assert!(is(19) || is(20), "{error}");
}

#[test]
fn a_session_that_has_truth_is_refused() {
    let folder = Recording::short().align().folder;
    let args = ["align", "aligned.csv", "--camera", "camera.csv", "--arm", arm(), "-o", "again.csv"];
    assert!(folder.refused(&args).starts_with("aligned.csv, line 1: column truth1_x_mm is there already"));
}

#[test]
fn a_column_that_the_camera_lacks_is_named() {
    for column in ["time_s", "truth4_y_mm", "truth6_heading_deg", "base_heading_deg"] {
        let error = refused(|recording| recording.camera.remove(column));
        assert_eq!(error, format!("camera.csv, line 1: column {column} is missing"));
    }
}

#[test]
fn a_column_that_is_there_twice_is_named() {
    for column in ["truth2_x_mm", "base_x_mm"] {
        let error = refused(|recording| recording.camera.push(column, "1"));
        assert_eq!(error, format!("camera.csv, line 1: column {column} is there twice"));
    }
}

#[test]
fn a_marker_beyond_the_arms_tip_is_named() {
    let error = refused(|recording| recording.camera.push("truth7_x_mm", "1"));
    assert_eq!(error, "camera.csv, line 1: column truth7_x_mm is of segment 7, but the arm has 6");
}

#[test]
fn bad_cells_of_the_camera_are_named_with_their_line_and_column() {
    let cases = [
        ("truth2_x_mm", "left", "\"left\" is not a number"),
        ("truth2_x_mm", "NaN", "NaN is not finite; a missing reading is an empty cell"),
        ("truth5_heading_deg", "", "the truth has an empty part, expected all of its cells or none"),
        ("base_y_mm", "1e12", "1e12 is out of range, expected at most 100 km or 16 000 turns"),
        ("time_s", "", "the cell is empty, expected a time"),
        ("time_s", "1e10", "time 1e10 s, expected one within 100 years of 0"),
    ];
    for (column, cell, problem) in cases {
        let error = refused(|recording| {
            let whole = recording.camera.rows[100].iter().all(|cell| !cell.is_empty());
            assert!(whole, "the case would be another");
            recording.camera.set(100, column, cell);
        });
        assert_eq!(error, format!("camera.csv, line 102, column {column}: {problem}"));
    }
}

#[test]
fn times_of_the_camera_that_go_backwards_are_refused() {
    let error = refused(|recording| recording.camera.rows.swap(200, 201));
    assert!(error.starts_with("camera.csv, line 203, column time_s: time goes backwards"), "{error}");
}

#[test]
fn a_camera_file_that_cannot_be_read_is_named() {
    let folder = Folder::with("session.csv", session().to_string());
    folder.write("session.csv", Recording::short().session.to_string());
    assert!(folder.refused(&args(arm())).starts_with("camera.csv: cannot be read"));
    folder.write("camera.csv", "");
    assert_eq!(folder.refused(&args(arm())), "camera.csv: is empty, expected a header line");
    let mut frames = Recording::short().camera;
    frames.rows.clear();
    folder.write("camera.csv", frames.to_string());
    assert!(folder.refused(&args(arm())).starts_with("camera.csv: has no samples"));
}

#[test]
fn a_row_of_the_camera_that_was_cut_is_named() {
    let folder = Recording::short().folder();
    let text = folder.read("camera.csv");
    folder.write("camera.csv", &text[..text.len() - 60]);
    let error = folder.refused(&args(arm()));
    assert!(error.starts_with("camera.csv, line ") && error.contains("the header 22"), "{error}");
}

#[test]
fn the_recordings_are_no_place_for_the_aligned_session() {
    for output in ["session.csv", "camera.csv"] {
        let folder = Recording::short().folder();
        let args = ["align", "session.csv", "--camera", "camera.csv", "--arm", arm(), "-o", output];
        assert!(folder.refused(&args).starts_with(&format!("{output}: is read by this command")));
    }
}

#[cfg(unix)]
#[test]
fn a_session_through_a_pipe_is_refused() {
    let folder = Recording::short().folder();
    let command = format!(
        "cat session.csv | {} align /dev/stdin --camera camera.csv --arm {} -o aligned.csv",
        env!("CARGO_BIN_EXE_proprio"),
        arm()
    );
    let run = std::process::Command::new("sh").args(["-c", &command]).current_dir(folder.path("")).output();
    let run = run.expect("sh starts");
    assert_eq!(run.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&run.stderr).contains("is a pipe or device"));
}
