//! Faults of wiring, mounting and sweeping: each is found by `calibrate` and named.

use super::common::{Calibration, Csv, Folder, arm, sweep};

/// The refusal of the sweep after `edit`, without the file's name.
fn refused(edit: impl FnOnce(&mut Csv)) -> String {
    let mut session = sweep();
    edit(&mut session);
    let folder = Folder::with("sweep.csv", session.to_string());
    let error = folder.refused(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "table.toml"]);
    error.strip_prefix("sweep.csv").unwrap_or_else(|| panic!("the session is not named: {error}")).to_owned()
}

/// Warnings of a calibration that succeeds all the same.
fn warnings(edit: impl FnOnce(&mut Csv)) -> Vec<String> {
    let mut session = sweep();
    edit(&mut session);
    let run = Calibration::of(&session).run;
    let stderr = &run.stderr;
    let warning = |line: &str| {
        line.strip_prefix("warning: sweep.csv: ").unwrap_or_else(|| panic!("no warning: {stderr}")).to_owned()
    };
    // The two segments of the twin's modules are always coupled.
    run.warnings().into_iter().map(warning).filter(|warning| !warning.contains("bend alike")).collect()
}

fn counts(cell: &str) -> u16 {
    cell.parse().expect("counts")
}

/// The reading below which `share` of a sensor's range lies.
fn at_share(session: &Csv, name: &str, share: f64) -> u16 {
    let readings = session.numbers(name);
    let (lo, hi) = readings.iter().fold((f64::MAX, 0.0_f64), |(lo, hi), n| (lo.min(*n), hi.max(*n)));
    (lo + share * (hi - lo)) as u16
}

/// True bend angle of segment 3 in each row, degrees.
fn theta_3(session: &Csv) -> Vec<f64> {
    let ends = ["truth3_heading_deg", "truth2_heading_deg"].map(|name| session.numbers(name));
    ends[0].iter().zip(&ends[1]).map(|(end, start)| end - start).collect()
}

/// Keeps the rows where segments 1 and 2, the first module, bend by less than `limit_deg` to either side.
fn keep_small(session: &mut Csv, limit_deg: f64) {
    let heading = session.numbers("truth2_heading_deg");
    let mut headings = heading.iter();
    session.rows.retain(|_| headings.next().is_some_and(|heading| heading.abs() < 2.0 * limit_deg));
}

#[test]
fn a_single_wrong_reading_leaves_the_limits_of_contact_as_they_are() {
    let limits = |session: &Csv| -> Vec<f64> {
        let table = Calibration::of(session).table();
        table.segments.iter().map(|segment| segment.contact.map_or(f64::NAN, |contact| contact.change_deg)).collect()
    };
    let good = limits(&sweep());
    let mut session = sweep();
    // The heading is far from 0 there: the reading is off by the whole angle.
    let headings = session.numbers("imu2_deg");
    let row = (600..headings.len()).find(|row| (90.0..270.0).contains(&headings[*row])).expect("the arm bends");
    session.map("imu2_deg", |at, cell| if at == row { "0.0000".to_owned() } else { cell.to_owned() });
    for (faulty, good) in limits(&session).into_iter().zip(good) {
        assert!((faulty - good).abs() < 0.5, "{faulty} instead of {good} degrees");
    }
}

#[test]
fn a_dead_sensor_is_named() {
    let error = refused(|session| session.map("bend3a_adc", |_, _| "2000".to_owned()));
    assert!(error.starts_with(": bend3a is dead"), "{error}");
}

#[test]
fn a_dead_sensor_with_noise_is_named() {
    let error = refused(|session| session.map("bend5b_adc", |row, _| (2000 + row * 7 % 11).to_string()));
    assert!(error.starts_with(": bend5b is dead"), "{error}");
}

#[test]
fn a_sensor_that_is_saturated_at_its_upper_end_is_named() {
    let error = refused(|session| {
        let limit = at_share(session, "bend2a_adc", 0.75);
        session.map("bend2a_adc", |_, cell| counts(cell).min(limit).to_string());
    });
    assert!(error.starts_with(": bend2a is saturated"), "{error}");
}

#[test]
fn a_sensor_that_is_saturated_at_its_lower_end_is_named() {
    let error = refused(|session| {
        let limit = at_share(session, "bend4b_adc", 0.5);
        session.map("bend4b_adc", |_, cell| counts(cell).max(limit).to_string());
    });
    assert!(error.starts_with(": bend4b is saturated"), "{error}");
}

/// The two segments of a module are coupled, so that either may be named with the sensor.
#[test]
fn sensors_swapped_between_modules_are_named() {
    let error = refused(|session| session.swap("bend1a_adc", "bend5a_adc"));
    assert!(error.starts_with(": bend1a follows segment") && error.contains("swapped"), "{error}");
    assert!(error.contains("segment 5") || error.contains("segment 6"), "{error}");
}

#[test]
fn sensors_b_swapped_between_modules_are_named() {
    let error = refused(|session| session.swap("bend3b_adc", "bend6b_adc"));
    assert!(error.starts_with(": bend3b follows segment") && error.contains("swapped"), "{error}");
}

#[test]
fn a_sensor_that_follows_nothing_is_named() {
    let error = refused(|session| session.map("bend3a_adc", |row, _| (500 + row * 7919 % 2503).to_string()));
    assert!(error.starts_with(": bend3a does not follow its segment"), "{error}");
}

#[test]
fn a_sensor_with_the_same_reading_left_and_right_is_named() {
    let error = refused(|session| {
        let theta = theta_3(session);
        session.map("bend3a_adc", |row, _| format!("{:.0}", 2000.0 + 1500.0 * (theta[row] / 60.0).powi(2)));
    });
    assert!(error.starts_with(": bend3a "), "{error}");
}

/// θ falls off to both sides of 2000 counts: the map that explains all of it turns back there.
#[test]
fn a_sensor_whose_map_turns_back_is_named() {
    let error = refused(|session| {
        let theta = theta_3(session);
        session.map("bend3a_adc", |row, _| {
            let side = if row % 2 == 0 { 1000.0 } else { -600.0 };
            format!("{:.0}", 2000.0 + side * ((62.0 - theta[row]) / 125.0).max(0.0).sqrt())
        });
    });
    assert!(error.starts_with(": bend3a is not monotonic"), "{error}");
}

#[test]
fn an_inverted_sensor_is_named_and_calibrated() {
    let warnings = warnings(|session| session.map("bend3a_adc", |_, cell| (4095 - counts(cell)).to_string()));
    let [warning] = &warnings[..] else { panic!("one warning, found {warnings:?}") };
    assert!(warning.starts_with("bend3a is inverted"), "{warning}");
}

/// Its map allows for it: the mirrored readings give the angles that the readings themselves would have given.
#[test]
fn an_inverted_sensors_map_is_the_mirrored_one() {
    let mut inverted = sweep();
    inverted.map("bend3a_adc", |_, cell| (4095 - counts(cell)).to_string());
    let map = |session: &Csv| Calibration::of(session).table().segments[2].bend.as_ref().expect("a table")[0].clone();
    let (straight, mirrored) = (map(&sweep()), map(&inverted));
    for volts in straight.volts.expect("a calibration states the range") {
        let error = straight.angle(volts) - mirrored.angle(3.3 - volts);
        // Two least-squares solutions of the same data, in f64.
        assert!(error.abs() < 1e-9, "{error} rad at {volts} V");
    }
}

#[test]
fn a_sweep_that_is_too_small_is_named() {
    let error = refused(|session| keep_small(session, 4.0));
    assert!(error.starts_with(": segment 1 bends by only 8") || error.starts_with(": segment 1 bends by only 7"));
}

#[test]
fn a_narrow_sweep_is_warned_about() {
    let warnings = warnings(|session| keep_small(session, 15.0));
    for segment in [1, 2] {
        let start = format!("segment {segment} bends by only 3");
        assert!(warnings.iter().any(|warning| warning.starts_with(&start)), "{warnings:?}");
    }
}

#[test]
fn a_sensor_b_without_its_a_is_named() {
    let error = refused(|session| session.remove("bend2a_adc"));
    assert!(error.contains("bend2a_adc is missing") && error.contains("bend2b_adc"), "{error}");
}

#[test]
fn swapped_imus_of_two_modules_are_named() {
    let error = refused(|session| session.swap("imu2_deg", "imu5_deg"));
    assert!(error.starts_with(": imu2 follows the end of segment 5") && error.contains("swapped"), "{error}");
}

#[test]
fn swapped_imus_on_either_side_of_a_module_joint_are_named() {
    let error = refused(|session| session.swap("imu3_deg", "imu4_deg"));
    assert!(error.starts_with(": imu3 ") && error.contains("swapped"), "{error}");
}

/// Neighbours on the mux. They turn alike, the second twice as far.
#[test]
fn swapped_imus_of_the_first_module_are_named() {
    let error = refused(|session| session.swap("imu1_deg", "imu2_deg"));
    assert!(error.starts_with(": imu1 ") && error.contains("imu2"), "{error}");
}

#[test]
fn an_inverted_imu_is_named() {
    for i in 1..=6 {
        let error = refused(|session| {
            session.map(&format!("imu{i}_deg"), |_, deg| (360.0 - deg.parse::<f64>().expect("a number")).to_string());
        });
        assert!(error.starts_with(&format!(": imu{i} is inverted")), "{error}");
    }
}

#[test]
fn an_imu_that_stands_still_is_named() {
    let error = refused(|session| session.map("imu3_deg", |_, _| "77".to_owned()));
    assert!(error.starts_with(": imu3 does not follow"), "{error}");
}

#[test]
fn an_imu_that_was_not_read_is_warned_about() {
    let warnings = warnings(|session| session.map("imu3_deg", |_, _| String::new()));
    // The comparison of the methods may have another.
    assert!(warnings[0].starts_with("imu3 was not read"), "{warnings:?}");
}

#[test]
fn a_session_without_truth_is_refused_by_its_column() {
    let error = refused(|session| session.remove("truth"));
    assert!(error.starts_with(", line 1: ") && error.contains("truth1_x_mm"), "{error}");
}

#[test]
fn a_session_whose_truth_is_empty_is_refused() {
    let error = refused(|session| {
        for name in session.names.clone().iter().filter(|name| name.starts_with("truth")) {
            session.map(name, |_, _| String::new());
        }
    });
    assert!(error.starts_with(": the camera saw segment 1 in 0 rows"), "{error}");
}

#[test]
fn a_segment_that_the_camera_never_saw_is_named() {
    let error = refused(|session| {
        for part in ["x_mm", "y_mm", "heading_deg"] {
            session.map(&format!("truth4_{part}"), |_, _| String::new());
        }
    });
    assert!(error.starts_with(": the camera saw segment 4 in 0 rows"), "{error}");
}

#[test]
fn too_few_rows_are_refused() {
    let error = refused(|session| {
        session.rows.drain(..1000);
        session.rows.truncate(40);
    });
    assert!(error.contains("40 rows"), "{error}");
}

#[test]
fn a_sensor_with_too_few_readings_is_named() {
    let error = refused(|session| {
        session.map("bend4a_adc", |row, cell| if row % 200 == 0 { cell.to_owned() } else { String::new() });
    });
    assert!(error.starts_with(": bend4a has 30 rows"), "{error}");
}

#[test]
fn a_session_without_bend_sensors_is_refused() {
    let error = refused(|session| session.remove("bend"));
    assert!(error.contains("no bend sensor"), "{error}");
}

#[test]
fn a_bad_cell_is_refused_with_its_line_and_column() {
    let error = refused(|session| session.set(3000, "bend1a_adc", "4096"));
    assert!(error.starts_with(", line 3002, column bend1a_adc: "), "{error}");
}

#[test]
fn the_description_of_a_shorter_arm_is_refused() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    let description = std::fs::read_to_string(arm()).expect("the description is committed");
    let last = description.rfind("[[segment]]").expect("it has segments");
    folder.write("arm.toml", &description[..last]);
    let error = folder.refused(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "table.toml"]);
    assert!(error.starts_with("sweep.csv, line 1: ") && error.contains("segment 6"), "{error}");
}

#[test]
fn truth_with_a_mirrored_axis_is_refused() {
    let error = refused(|session| {
        for i in 1..=6 {
            session.map(&format!("truth{i}_x_mm"), |_, x| format!("{}", -x.parse::<f64>().expect("a number")));
        }
    });
    assert!(error.contains("the truth's points are"), "{error}");
}

fn in_radians(session: &mut Csv, imu: usize) {
    session.map(&format!("imu{imu}_deg"), |_, cell| {
        let degrees: f64 = cell.parse().expect("a number");
        format!("{:.4}", degrees.to_radians())
    });
}

#[test]
fn an_imu_in_radians_is_blamed_and_no_exchange() {
    for imu in [1, 3, 6] {
        let error = refused(|session| in_radians(session, imu));
        assert!(error.starts_with(&format!(": imu{imu} is in radians in a column of degrees")), "{error}");
    }
}

#[test]
fn an_imu_in_radians_is_found_in_the_one_session_that_has_it() {
    let folder = Folder::with("good.csv", sweep().to_string());
    folder.write("again.csv", sweep().to_string());
    let mut session = sweep();
    in_radians(&mut session, 3);
    folder.write("radians.csv", session.to_string());
    let command = ["calibrate", "good.csv", "again.csv", "radians.csv", "--arm", arm(), "-o", "table.toml"];
    let error = folder.refused(&command);
    assert!(error.starts_with("radians.csv: imu3 is in radians"), "{error}");
    let stderr = folder.run(&command).stderr;
    assert!(stderr.contains("rename the column to imu3_rad"), "{stderr}");
}
