//! `calibrate` on good sweeps: the table, the report, and what the table's estimates are worth.

use super::common::{Calibration, Csv, Folder, anchored, arm, figure, json, sweep, table};

const SENSORS: [&str; 12] = [
    "bend1a", "bend1b", "bend2a", "bend2b", "bend3a", "bend3b", "bend4a", "bend4b", "bend5a", "bend5b", "bend6a",
    "bend6b",
];

/// Name and RMSE of each line of the report.
fn rmses(stdout: &str) -> Vec<(String, f64)> {
    let cells = stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let sensors = cells.filter(|cells| cells.first().is_some_and(|name| SENSORS.contains(name)));
    sensors.map(|cells| (cells[0].to_owned(), cells[2].parse().expect("an RMSE"))).collect()
}

#[test]
fn every_sensors_rmse_is_printed_and_is_that_of_the_table() {
    let calibration = Calibration::of(&sweep());
    let table = calibration.table();
    let maps: Vec<_> = table.segments.iter().flat_map(|segment| segment.bend.iter().flatten()).collect();
    let printed = rmses(&calibration.run.stdout);
    let names: Vec<&str> = printed.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, SENSORS);
    assert_eq!(maps.len(), SENSORS.len());
    for ((name, rmse), map) in printed.iter().zip(maps) {
        let of_table = map.rmse_deg.expect("a calibration states the residual");
        assert!((rmse - of_table).abs() < 0.0051, "{name}: {rmse} printed, {of_table} in the table");
    }
}

/// The RMSE is that of the table's map against the sweep's truth, computed independently from the CSV.
#[test]
fn the_rmse_is_that_of_the_maps_on_the_sweep() {
    let (sweep, table) = (sweep(), Calibration::of(&sweep()).table());
    for (i, segment) in (1..).zip(&table.segments) {
        for (map, place) in segment.bend.iter().flatten().zip(['a', 'b']) {
            let counts = sweep.numbers(&format!("bend{i}{place}_adc"));
            let theta = true_theta_deg(&sweep, i);
            let errors = counts.iter().zip(&theta).map(|(counts, theta)| {
                let volts = counts * 3.3 / 4095.0;
                ((map.c2 * volts + map.c1) * volts + map.c0).to_degrees() - theta
            });
            let rmse = (errors.map(|error| error * error).sum::<f64>() / counts.len() as f64).sqrt();
            assert!((rmse - map.rmse_deg.expect("stated")).abs() < 1e-6, "bend{i}{place}: {rmse}");
        }
    }
}

fn true_theta_deg(session: &Csv, segment: usize) -> Vec<f64> {
    let heading = session.numbers(&format!("truth{segment}_heading_deg"));
    if segment == 1 {
        return heading;
    }
    let before = session.numbers(&format!("truth{}_heading_deg", segment - 1));
    heading.iter().zip(before).map(|(heading, before)| heading - before).collect()
}

#[test]
fn a_good_sweep_has_no_warning_but_that_the_segments_of_a_module_bend_alike() {
    let run = Calibration::of(&sweep()).run;
    let warnings = run.warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("segments 1 and 2, 3 and 4, 5 and 6 bend alike"), "{warnings:?}");
}

#[test]
fn the_table_is_a_table_of_the_arm() {
    let table = Calibration::of(&sweep()).table();
    let description = calibration_tables::ArmFile::parse(calibration_tables::PLANAR_6_ARM).expect("it is committed");
    assert_eq!((&table.arm, table.rate_hz, &table.tare), (&description.arm, description.rate_hz, &description.tare));
    for (segment, of_description) in table.segments.iter().zip(&description.segments) {
        assert_eq!(segment.length_mm.to_bits(), of_description.length_mm.to_bits());
        assert_eq!(segment.offset_mm.to_bits(), of_description.offset_mm.to_bits());
        assert_eq!(segment.offset_at, of_description.offset_at);
    }
    assert_eq!(table.segments.len(), description.segments.len());
    assert_eq!(table.bend_sensors().expect("it is a table"), [2; 6]);
}

#[test]
fn the_same_sweep_gives_the_same_bytes() {
    let [one, other] = [(); 2].map(|()| Calibration::of(&sweep()).folder.read("table.toml"));
    assert_eq!(one, other);
}

#[test]
fn a_table_can_be_calibrated_again() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    folder.done(&["calibrate", "sweep.csv", "--arm", arm(), "-o", "of-arm.toml"]);
    folder.done(&["calibrate", "sweep.csv", "--arm", table(), "-o", "of-table.toml"]);
    assert_eq!(folder.read("of-arm.toml"), folder.read("of-table.toml"));
}

/// Camera software gives headings within a turn; the arm curls through more than that.
#[test]
fn true_headings_within_a_turn_give_the_same_maps() {
    let expected = Calibration::of(&sweep()).table();
    for lowest in [-180.0, 0.0] {
        let mut wrapped = sweep();
        for i in 1..=6 {
            let wrap = |deg: f64| (deg - lowest).rem_euclid(360.0) + lowest;
            wrapped
                .map(&format!("truth{i}_heading_deg"), |_, deg| format!("{:.4}", wrap(deg.parse().expect("a number"))));
        }
        assert!(wrapped != sweep(), "else this test shows nothing");
        let found = Calibration::of(&wrapped).table();
        for (i, (found, expected)) in found.segments.iter().zip(&expected.segments).enumerate() {
            for (found, expected) in found.bend.iter().flatten().zip(expected.bend.iter().flatten()) {
                let volts = expected.volts.expect("a calibration states the range");
                for v in volts {
                    // Headings have four decimals and are rounded once more.
                    let error_deg = (found.angle(v) - expected.angle(v)).to_degrees().abs();
                    assert!(error_deg < 1e-3, "segment {}: {error_deg}° from {lowest}°", i + 1);
                }
            }
        }
    }
}

#[test]
fn every_sensor_gets_a_map_and_a_memory_by_held_back_error_and_every_segment_its_errors() {
    let table = Calibration::of(&sweep()).table();
    assert_eq!(table.drift.as_ref().map(|drift| drift.kind), Some(calibration_tables::DriftKind::Kalman));
    for (i, segment) in (1..).zip(&table.segments) {
        let sensors = segment.bend.as_ref().expect("it is a table");
        assert!(sensors.iter().any(|sensor| sensor.curve.is_some()), "segment {i}");
        let error = segment.bend_error.as_ref().expect("the sweep shows it");
        assert_eq!(error.sensor_deg.len(), sensors.len());
        let worst = error.sensor_deg.iter().copied().fold(0.0, f64::max);
        assert!((0.3..=worst).contains(&error.mean_deg), "segment {i}: {error:?}");
        // The twin's gyroscopes are within 3 %, as the BNO055's.
        let scale = segment.imu_scale.expect("the sweep shows it");
        assert!((scale - 1.0).abs() < 0.03, "segment {i}: {scale}");
        assert!(segment.orient.is_none() && segment.hysteresis.is_empty());
    }
}

#[test]
fn the_expected_error_of_each_segment_is_printed() {
    let stdout = Calibration::of(&sweep()).run.stdout;
    let lines = stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let segments: Vec<_> = lines.filter(|cells| cells.len() > 3 && cells[0].len() == 1).collect();
    assert_eq!(segments.iter().map(|cells| cells[0]).collect::<Vec<_>>(), ["1", "2", "3", "4", "5", "6"]);
    for cells in segments {
        let error_deg: f64 = cells[1].parse().expect("an error");
        assert!((0.1..5.0).contains(&error_deg), "{cells:?}");
    }
}

#[test]
fn the_methods_are_compared_on_the_last_fifth() {
    let stdout = Calibration::of(&sweep()).run.stdout;
    let rmse_mm = |method: &str| -> f64 {
        let line = stdout.lines().find(|line| line.split_whitespace().next() == Some(method)).expect("a line each");
        line.split_whitespace().last().expect("two cells").parse().expect("an RMSE")
    };
    assert!(rmse_mm("fusion") < rmse_mm("bend") && rmse_mm("fusion") < rmse_mm("imu_o"), "{stdout}");
}

#[test]
fn an_arm_with_the_anchor_gets_the_papers_table() {
    let folder = Folder::with("sweep.csv", sweep().to_string());
    folder.write("arm.toml", anchored());
    folder.done(&["calibrate", "sweep.csv", "--arm", "arm.toml", "--map", "quadratic", "-o", "quadratic.toml"]);
    folder.done(&["calibrate", "sweep.csv", "--arm", "arm.toml", "-o", "auto.toml"]);
    let text = folder.read("quadratic.toml");
    assert_eq!(text, folder.read("auto.toml"));
    for key in ["curve", "memory", "bend_error", "imu_scale"] {
        assert!(!text.contains(key), "{key}");
    }
    assert_eq!(text.matches("orient = ").count(), 6);
}

/// The bend sensors of the second day have another offset, half of it to either side of the pooled maps.
#[test]
fn what_changes_between_two_sweeps_widens_the_offset() {
    let mut other = sweep();
    for i in 1..=6 {
        // Their maps run against each other.
        for (place, counts) in [('a', 20), ('b', -20)] {
            other.map(&format!("bend{i}{place}_adc"), |_, cell| {
                (cell.parse::<i32>().expect("counts") + counts).clamp(0, 4095).to_string()
            });
        }
    }
    let offset_deg = |second: &Csv| {
        let folder = Folder::with("one.csv", sweep().to_string());
        folder.write("two.csv", second.to_string());
        folder.done(&["calibrate", "one.csv", "two.csv", "--arm", arm(), "-o", "table.toml"]);
        let table = calibration_tables::ArmFile::parse(&folder.read("table.toml")).expect("a table");
        table.drift.expect("calibrate writes it").offset_deg
    };
    assert_eq!(offset_deg(&sweep()).to_bits(), 0.5_f64.to_bits());
    assert!((0.7..10.0).contains(&offset_deg(&other)), "{}", offset_deg(&other));
    let of_one = Calibration::of(&sweep()).table().drift.expect("calibrate writes it");
    assert_eq!(of_one, calibration_tables::DriftToml::kalman());
}

#[test]
fn sweeps_of_different_rates_are_refused() {
    let folder = Folder::with("one.csv", sweep().to_string());
    let mut other = sweep();
    other.map("time_s", |row, _| format!("{:.3}", row as f64 * 0.013));
    folder.write("two.csv", other.to_string());
    let error = folder.refused(&["calibrate", "one.csv", "two.csv", "--arm", arm(), "-o", "table.toml"]);
    assert!(error.starts_with("two.csv: the sample rate is"), "{error}");
}

fn check_scenario(scenario: u64) {
    let folder = Calibration::of(&sweep()).folder;
    let (name, seed) = (scenario.to_string(), (30 + scenario).to_string());
    folder.done(&["simulate", "--scenario", &name, "--seconds", "900", "--seed", &seed, "-o", "session.csv"]);
    let report = json(&folder.done(&["replay", "session.csv", "--table", "table.toml", "--json"]));
    let rmse = |method| figure(&report, method, "tip_rmse_mm");
    for method in ["bend", "imu_o"] {
        assert!(
            rmse("fusion") < rmse(method) * 2.0 / 3.0,
            "fusion {} mm, {method} {} mm",
            rmse("fusion"),
            rmse(method)
        );
    }
    // Behind the bias filter a filter that is not tuned has next to nothing to add; it takes nothing from most runs, and this
    // much from none.
    assert!(rmse("fusion") < 1.1 * rmse("imu_c"), "fusion {} mm, imu_c {} mm", rmse("fusion"), rmse("imu_c"));
    // The paper's figure in the same scenario (Table I).
    let of_paper = [10.97, 20.24, 23.59][scenario as usize - 1];
    assert!(rmse("fusion") < of_paper, "fusion {} mm", rmse("fusion"));
}

#[test]
fn fusion_is_as_good_as_the_best_method_in_free_swings() {
    check_scenario(1);
}

#[test]
fn fusion_is_as_good_as_the_best_method_under_pushes() {
    check_scenario(2);
}

#[test]
fn fusion_is_as_good_as_the_best_method_around_an_obstacle() {
    check_scenario(3);
}
