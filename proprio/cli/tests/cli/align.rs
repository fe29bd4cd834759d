//! `align` on recordings that fit together: the clocks that it finds, the truth that it writes, and what that is worth.

use super::common::{Csv, Folder, arm, figure, json, simulate, table};
use super::recordings::{Aligned, Recording};

const TRUTH_COLUMNS: usize = 18;

#[test]
fn clocks_are_found_to_5_ms_and_10_ppm_at_10_hz() {
    for (offset_s, ppm) in [(-1234.567, 80.0), (1.7e9, -150.0), (0.0, 0.0), (86_400.3, 999.0)] {
        let aligned = Recording::long().with_clock(offset_s, ppm).align();
        let (error_ms, skew_ppm) = (aligned.offset_error_ms(offset_s, ppm), aligned.skew_ppm());
        assert!(error_ms.abs() < 5.0, "{offset_s} s, {ppm} ppm: {error_ms} ms");
        assert!((skew_ppm - ppm).abs() < 10.0, "{offset_s} s, {ppm} ppm: {skew_ppm}");
    }
}

#[test]
fn clocks_are_found_to_2_ms_and_10_ppm_at_100_hz() {
    for scenario in ["sweep", "2", "3"] {
        let folder = Folder::new();
        let simulation = ["simulate", "--scenario", scenario, "--seconds", "900", "--seed", "73", "--rate", "100"];
        folder.done(&[&simulation[..], &["--camera", "camera.csv", "-o", "session.csv"]].concat());
        let aligned = Aligned::of(folder);
        // The twin's own camera.
        let (error_ms, skew_ppm) = (aligned.offset_error_ms(1.76e9, 80.0), aligned.skew_ppm());
        assert!(error_ms.abs() < 2.0, "scenario {scenario}: {error_ms} ms");
        assert!((skew_ppm - 80.0).abs() < 10.0, "scenario {scenario}: {skew_ppm} ppm");
    }
}

/// An estimated error must not be too small.
#[test]
fn the_residual_separates_a_wandering_clock_from_a_steady_one() {
    let steady = Recording::short().align().numbers("residual")[0];
    let mut recording = Recording::short();
    // A triangle of ±25 ms: 14.4 ms RMS.
    recording.retime(|time_s| time_s + 0.1 * ((time_s / 150.0).fract() - 0.5).abs());
    let wandering = recording.align().numbers("residual")[0];
    assert!(steady < 3.0, "{steady} ms");
    assert!((10.0..18.0).contains(&wandering), "{wandering} ms");
}

#[test]
fn a_camera_that_saw_a_part_is_aligned_and_the_other_rows_stay_empty() {
    let mut recording = Recording::long();
    recording.keep_frames(|time_s| (301.0..=499.0).contains(&time_s));
    let aligned = recording.with_clock(-50.0, 20.0).align();
    assert!(aligned.offset_error_ms(-50.0, 20.0).abs() < 5.0, "{}", aligned.run.stdout);
    let csv = aligned.csv();
    for (row, cells) in csv.rows.iter().enumerate() {
        let time_s: f64 = csv.cell(row, "time_s").parse().expect("a time");
        let truth = &cells[cells.len() - TRUTH_COLUMNS..];
        if (301.2..=498.8).contains(&time_s) {
            assert!(truth.iter().all(|cell| !cell.is_empty()), "{time_s} s");
        } else if !(300.9..=499.1).contains(&time_s) {
            assert!(truth.iter().all(String::is_empty), "{time_s} s: nothing is extrapolated");
        }
    }
    let with_truth = csv.rows.iter().filter(|cells| cells.iter().all(|cell| !cell.is_empty())).count();
    let expected = format!("{with_truth} of 9000 rows");
    assert!(aligned.run.stdout.contains(&expected), "{expected}: {}", aligned.run.stdout);
}

#[test]
fn a_session_that_is_a_part_of_what_the_camera_saw_is_aligned() {
    let mut recording = Recording::long();
    recording.keep_samples(|time_s| (400.0..520.0).contains(&time_s));
    let aligned = recording.with_clock(1e6, -40.0).align();
    assert!(aligned.offset_error_ms(1e6, -40.0).abs() < 5.0, "{}", aligned.run.stdout);
    assert!(aligned.run.stdout.contains(" of 1200 rows"), "{}", aligned.run.stdout);
}

#[test]
fn every_cell_of_the_session_stays_as_it_is() {
    let mut session = Recording::short().session;
    session.map("time_s", |row, text| if row % 2 == 0 { format!(" {text} ") } else { text.to_owned() });
    session.rename("bend1a_adc", " bend1a_adc");
    session.push("note", "\"a, \"\"b\"\"\"");
    session.push("bare", "x y ");
    let text = session.to_string();
    let folder = Recording::short().folder();
    folder.write("session.csv", format!("\u{feff}{}", text.replace('\n', "\r\n")));
    let aligned = Aligned::of(folder).folder.read("aligned.csv");
    let aligned = aligned.strip_prefix('\u{feff}').expect("the byte-order mark stays");
    assert_eq!(aligned.lines().count(), text.lines().count());
    for (line, (found, expected)) in aligned.lines().zip(text.lines()).enumerate() {
        let truth = found.strip_prefix(expected).unwrap_or_else(|| panic!("line {line}: {found}"));
        assert_eq!(truth.matches(',').count(), TRUTH_COLUMNS, "line {line}");
    }
}

#[test]
fn empty_lines_and_a_last_line_without_an_end_are_read() {
    let recording = Recording::short();
    let folder = recording.folder();
    let text = recording.session.to_string();
    folder.write("session.csv", text.trim_end().replacen('\n', "\n\n", 7));
    let aligned = Aligned::of(folder);
    assert!(aligned.run.stderr.contains("session.csv: the last line has no end"), "{}", aligned.run.stderr);
    for (found, expected) in aligned.folder.read("aligned.csv").lines().zip(text.lines()) {
        assert!(found.starts_with(&format!("{expected},")), "{found}");
    }
}

/// Root mean square difference of two columns, where both have a number.
fn difference(found: &Csv, expected: &Csv, name: &str) -> f64 {
    let numbers = |csv: &Csv, row: usize| csv.cell(row, name).parse::<f64>().ok();
    let squares =
        (0..found.rows.len()).filter_map(|row| Some((numbers(found, row)? - numbers(expected, row)?).powi(2)));
    let squares: Vec<f64> = squares.collect();
    assert!(squares.len() > found.rows.len() * 95 / 100, "{name}: {} rows", squares.len());
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// The camera's noise is 1 mm and 0.5°; the base is seen turned by 4°, a quarter of a metre away.
#[test]
fn the_truth_is_that_of_the_arm_in_the_bases_frame_but_for_the_cameras_noise() {
    let expected = simulate("--scenario 1 --seconds 300 --seed 71");
    let found = Recording::short().align().csv();
    for i in 1..=6 {
        for (part, least, most) in [("x_mm", 0.7, 1.3), ("y_mm", 0.7, 1.3), ("heading_deg", 0.35, 0.65)] {
            let name = format!("truth{i}_{part}");
            let difference = difference(&found, &expected, &name);
            assert!((least..most).contains(&difference), "{name}: {difference}");
        }
    }
}

/// A file in {W}, of the form of a session: other columns, and those of the truth in metres and radians.
#[test]
fn a_camera_without_a_base_is_in_the_worlds_frame_and_may_have_metres_and_radians() {
    let mut camera = simulate("--scenario 1 --seconds 300 --seed 71 --rate 100");
    let expected = simulate("--scenario 1 --seconds 300 --seed 71");
    for i in 1..=6 {
        for (from, to, factor) in
            [("x_mm", "x_m", 1e-3), ("y_mm", "y_m", 1e-3), ("heading_deg", "heading_rad", 0.017_453_292_52)]
        {
            let (from, to) = (format!("truth{i}_{from}"), format!("truth{i}_{to}"));
            camera.map(&from, |_, text| format!("{:.9}", text.parse::<f64>().expect("a number") * factor));
            camera.rename(&from, &to);
        }
    }
    let found = Recording { camera, ..Recording::short() }.align().csv();
    for i in 1..=6 {
        // The offset is right to some milliseconds, and the tip moves by some hundred millimetres a second.
        for (part, most) in [("x_mm", 1.0), ("y_mm", 1.0), ("heading_deg", 0.3)] {
            let name = format!("truth{i}_{part}");
            assert!(difference(&found, &expected, &name) < most, "{name}");
        }
    }
}

/// Camera software gives headings within a turn; interpolated there, a pose would look backwards.
#[test]
fn headings_are_interpolated_through_a_turn() {
    let mut recording = Recording::short();
    for i in 1..=6 {
        recording.camera.map(&format!("truth{i}_heading_deg"), |_, text| match text.parse::<f64>() {
            // As if the camera's picture were turned by 170°.
            Ok(deg) => format!("{:.4}", (deg + 170.0 + 180.0).rem_euclid(360.0) - 180.0),
            Err(_) => String::new(),
        });
    }
    recording.camera.remove("base");
    let csv = recording.align().csv();
    for i in 1..=6 {
        let column = csv.column(&format!("truth{i}_heading_deg"));
        let headings: Vec<f64> = csv.rows.iter().filter_map(|row| row[column].parse().ok()).collect();
        let jump = headings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(jump < 30.0, "segment {i}: {jump}° in a tenth of a second");
    }
}

#[test]
fn nothing_is_interpolated_across_more_than_a_fifth_of_a_second() {
    let mut recording = Recording::short();
    recording.keep_frames(|time_s| !(100.01..100.3).contains(&time_s) && !(200.05..200.15).contains(&time_s));
    let csv = recording.align().csv();
    let has_truth = |row: usize| csv.rows[row].iter().all(|cell| !cell.is_empty());
    assert!(!has_truth(1001) && !has_truth(1002), "no frame within 0.29 s");
    assert!(has_truth(2001), "frames 0.1 s apart");
}

#[test]
fn a_marker_that_was_hidden_leaves_its_own_cells_empty() {
    let mut recording = Recording::short();
    for part in ["x_mm", "y_mm", "heading_deg"] {
        let hide = |row, text: &str| if (3000..3300).contains(&row) { String::new() } else { text.to_owned() };
        recording.camera.map(&format!("truth3_{part}"), hide);
    }
    let csv = recording.align().csv();
    let empty = |name: &str| (0..csv.rows.len()).filter(|row| csv.cell(*row, name).is_empty()).count();
    // 300 frames are 10 s and a few that were dropped.
    assert!((95..115).contains(&empty("truth3_x_mm")), "{}", empty("truth3_x_mm"));
    assert_eq!(empty("truth3_x_mm"), empty("truth3_heading_deg"));
    assert!(empty("truth4_x_mm") < 5, "{}", empty("truth4_x_mm"));
}

/// Bend sensors lag and overshoot, which limits the offset and shows in the residual.
#[test]
fn bend_sensors_do_where_no_imu_was_read() {
    let mut recording = Recording::long();
    for i in 1..=6 {
        recording.session.map(&format!("imu{i}_deg"), |_, _| String::new());
    }
    let aligned = recording.with_clock(777.0, 30.0).align();
    assert!(aligned.run.stdout.contains("bend sensors"), "{}", aligned.run.stdout);
    assert!(aligned.offset_error_ms(777.0, 30.0).abs() < 50.0, "{}", aligned.run.stdout);
    assert!((aligned.skew_ppm() - 30.0).abs() < 30.0, "{}", aligned.run.stdout);
    assert!(aligned.numbers("residual")[0] > 3.0, "{}", aligned.run.stdout);
}

/// `calibrate` names the sensor then; it needs the truth for it.
#[test]
fn one_imu_that_is_wrong_spoils_nothing() {
    let mut recording = Recording::short();
    recording.session.map("imu2_deg", |_, text| format!("{:.5}", 360.0 - text.parse::<f64>().expect("a heading")));
    let aligned = recording.with_clock(5.0, 0.0).align();
    assert!(aligned.offset_error_ms(5.0, 0.0).abs() < 5.0, "{}", aligned.run.stdout);
    let error = aligned.folder.refused(&["calibrate", "aligned.csv", "--arm", arm(), "-o", "table.toml"]);
    assert!(error.contains("imu2 is inverted"), "{error}");
}

/// The lowest rate of the twin, and an arm without bend sensors.
#[test]
fn a_slow_session_of_quaternions_is_aligned_too() {
    let mut recording = Recording::simulate("--scenario sweep --seconds 600 --seed 79 --rate 1 --imu quaternion");
    recording.session.remove("bend");
    let aligned = recording.with_clock(3.0, 10.0).align();
    assert!(aligned.offset_error_ms(3.0, 10.0).abs() < 20.0, "{}", aligned.run.stdout);
    assert!((aligned.skew_ppm() - 10.0).abs() < 30.0, "{}", aligned.run.stdout);
}

#[test]
fn a_table_serves_as_the_arms_description() {
    let folder = Recording::short().folder();
    folder.done(&["align", "session.csv", "--camera", "camera.csv", "--arm", table(), "-o", "aligned.csv"]);
    assert_eq!(folder.read("aligned.csv"), Recording::short().align().folder.read("aligned.csv"));
}

#[test]
fn replays_figures_are_those_of_the_true_truth() {
    let recording = Recording::long().with_clock(-1234.567, 80.0);
    let folder = recording.align().folder;
    folder.write("true.csv", simulate("--scenario 1 --seconds 900 --seed 72").to_string());
    let report = |name: &str| json(&folder.done(&["replay", name, "--table", table(), "--json"]));
    let (found, expected) = (report("aligned.csv"), report("true.csv"));
    for method in ["bend", "imu_o", "imu_c", "fusion"] {
        let [found, expected] = [&found, &expected].map(|report| figure(report, method, "tip_rmse_mm"));
        // 1 mm of the camera's noise either way, and an offset of a millisecond or two.
        let expected = expected.hypot(2_f64.sqrt());
        assert!((found - expected).abs() < 0.03 * expected, "{method}: {found} mm, expected {expected} mm");
    }
}

#[test]
fn a_table_of_an_aligned_sweep_is_as_good_as_one_of_the_true_truth() {
    let sweep = "--scenario sweep --seconds 600 --seed 74";
    let folder = Recording::simulate(sweep).align().folder;
    folder.write("true.csv", simulate(sweep).to_string());
    folder.write("other.csv", simulate("--scenario 2 --seconds 300 --seed 75").to_string());
    let fusion = |session: &str| {
        folder.done(&["calibrate", session, "--arm", arm(), "--force", "-o", "table.toml"]);
        figure(
            &json(&folder.done(&["replay", "other.csv", "--table", "table.toml", "--json"])),
            "fusion",
            "tip_rmse_mm",
        )
    };
    let (found, expected) = (fusion("aligned.csv"), fusion("true.csv"));
    // 0.05 % of the arm's length, from the camera's noise in the maps.
    assert!((found - expected).abs() < 0.3, "{found} mm, expected {expected} mm");
}

#[test]
fn the_same_files_give_the_same_bytes() {
    let [one, other] = [(); 2].map(|()| Recording::short().align());
    assert_eq!(one.run.stdout, other.run.stdout);
    assert_eq!(one.folder.read("aligned.csv"), other.folder.read("aligned.csv"));
}
