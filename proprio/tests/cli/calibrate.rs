//! `calibrate` on good sweeps: the table, the report, and what the table's estimates are worth.

use super::common::{Calibration, Csv, Folder, arm, figure, json, sweep, table};

const SENSORS: [&str; 12] = [
    "bend1a", "bend1b", "bend2a", "bend2b", "bend3a", "bend3b", "bend4a", "bend4b", "bend5a", "bend5b", "bend6a",
    "bend6b",
];

/// Name and RMSE of each line of the report.
fn rmses(stdout: &str) -> Vec<(String, f64)> {
    let cells = stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let sensors = cells.filter(|cells| cells.first().is_some_and(|name| name.starts_with("bend")));
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

/// The RMSE is what the map of the table leaves of the sweep's truth, computed anew from the CSV.
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
    let stderr = Calibration::of(&sweep()).run.stderr;
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(stderr.contains("segments 1 and 2, 3 and 4, 5 and 6 bend alike"), "{stderr}");
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
fn a_table_can_be_calibrated_anew() {
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

fn check_scenario(scenario: u64) {
    let folder = Calibration::of(&sweep()).folder;
    let (name, seed) = (scenario.to_string(), (30 + scenario).to_string());
    folder.done(&["simulate", "--scenario", &name, "--seconds", "900", "--seed", &seed, "-o", "session.csv"]);
    let report = json(&folder.done(&["replay", "session.csv", "--table", "table.toml", "--json"]));
    let rmse = |method| figure(&report, method, "tip_rmse_mm");
    for method in ["bend", "imu_o"] {
        assert!(rmse("fusion") < rmse(method) / 2.0, "fusion {} mm, {method} {} mm", rmse("fusion"), rmse(method));
    }
    // Behind the observer a filter that is not tuned has next to nothing to add; it takes nothing from most runs, and this
    // much from none.
    assert!(rmse("fusion") < 1.1 * rmse("imu_c"), "fusion {} mm, imu_c {} mm", rmse("fusion"), rmse("imu_c"));
    // The paper's best figure in any scenario.
    assert!(rmse("fusion") < 10.97, "fusion {} mm", rmse("fusion"));
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
