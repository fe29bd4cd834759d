//! Sweeps with less than all: sensors that an arm does not have, and readings that are missing.

use super::common::{Calibration, Csv, report, sweep};

/// The two calibrations' maps of the same sensors must be within `limit_deg` over their voltage range.
fn near(found: &Calibration, expected: &Calibration, limit_deg: f64) {
    let (found, expected) = (found.table(), expected.table());
    for (i, (found, expected)) in found.segments.iter().zip(&expected.segments).enumerate() {
        let maps = [found, expected].map(|segment| segment.bend.as_ref().expect("a table"));
        for (j, (found, expected)) in maps[0].iter().zip(maps[1]).enumerate() {
            let [lo, hi] = expected.volts.expect("a calibration states the range");
            for step in 0..=20 {
                let volts = lo + (hi - lo) * f64::from(step) / 20.0;
                let error = (found.angle(volts) - expected.angle(volts)).to_degrees().abs();
                assert!(error < limit_deg, "segment {}, sensor {}: {error}° at {volts} V", i + 1, j + 1);
            }
        }
    }
}

/// Replays the sweep with its own table.
fn replays(calibration: &Calibration) {
    calibration.folder.done(&["replay", "sweep.csv", "--table", "table.toml", "--out", "est.csv"]);
}

fn sensors(calibration: &Calibration) -> Vec<usize> {
    calibration.table().bend_sensors().expect("a calibration makes a table")
}

fn without(prefix: &str) -> Csv {
    let mut session = sweep();
    session.remove(prefix);
    session
}

#[test]
fn a_segment_without_sensor_b_is_calibrated_with_one() {
    let calibration = Calibration::of(&without("bend3b_adc"));
    assert_eq!(sensors(&calibration), [2, 2, 1, 2, 2, 2]);
    assert!(calibration.run.stdout.contains("bend3a") && !calibration.run.stdout.contains("bend3b"));
    replays(&calibration);
}

#[test]
fn the_other_sensors_maps_do_not_mind() {
    let (all, without) = (Calibration::of(&sweep()), Calibration::of(&without("bend3b_adc")));
    let maps = |calibration: &Calibration| {
        let segments = calibration.table().segments;
        segments.into_iter().map(|segment| segment.bend.expect("a table")).collect::<Vec<_>>()
    };
    let (mut all, without) = (maps(&all), maps(&without));
    all[2].truncate(1);
    assert_eq!(all, without);
}

#[test]
fn a_segment_without_sensors_is_calibrated_with_none() {
    let calibration = Calibration::of(&without("bend3"));
    assert_eq!(sensors(&calibration), [2, 2, 0, 2, 2, 2]);
    replays(&calibration);
}

/// A tenth of the readings is missing. A parabola through n readings with a residual of σ is known to √(9/n) σ at the
/// ends of its range; leaving out a tenth of 6000 at random, with σ = 4°, moves it by 4° · √(9/6000 · 0.1) = 0.05°. At
/// the ends the sweep is sparser, hence six times that; it is a four-hundredth of the range.
#[test]
fn empty_cells_here_and_there_leave_the_maps_as_they_are() {
    let mut session = sweep();
    let names: Vec<String> =
        session.names.iter().filter(|name| name.starts_with("bend") || name.starts_with("imu")).cloned().collect();
    for (i, name) in names.iter().enumerate() {
        session.map(name, |row, cell| {
            // A multiplicative hash: no pattern that goes with the motion.
            let hash = ((row * 18 + i) as u32).wrapping_mul(2_654_435_769);
            if hash < u32::MAX / 10 { String::new() } else { cell.to_owned() }
        });
    }
    let empty = session.rows.iter().flatten().filter(|cell| cell.is_empty()).count();
    assert!(empty > 9 * 6000 * 18 / 100, "else this test shows nothing: {empty}");
    let calibration = Calibration::of(&session);
    near(&calibration, &Calibration::of(&sweep()), 0.3);
    replays(&calibration);
}

#[test]
fn truth_that_is_missing_now_and_then_leaves_the_maps_as_they_are() {
    let mut session = sweep();
    for part in ["x_mm", "y_mm", "heading_deg"] {
        session.map(&format!("truth4_{part}"), |row, cell| if row % 10 == 0 { String::new() } else { cell.to_owned() });
    }
    near(&Calibration::of(&session), &Calibration::of(&sweep()), 0.3);
}

/// A table must work on the readings it was made of: bend angles within its own residuals.
#[test]
fn the_sweeps_own_replay_is_as_good_as_its_residuals() {
    let calibration = Calibration::of(&sweep());
    let run = calibration.folder.done(&["replay", "sweep.csv", "--table", "table.toml", "--json"]);
    let found = super::common::figure(&super::common::json(&run), "bend", "theta_rmse_deg");
    let table = calibration.table();
    let maps: Vec<_> = table.segments.iter().flat_map(|segment| segment.bend.iter().flatten()).collect();
    let square = maps.iter().map(|map| map.rmse_deg.expect("stated").powi(2)).sum::<f64>() / maps.len() as f64;
    // The mean of two sensors is never worse than both of them, in the mean square.
    assert!(found <= square.sqrt() && found > 0.0, "{found}° by replay, {}° by the maps", square.sqrt());
}

#[test]
fn the_reference_table_fits_the_sweep_of_another_day() {
    let found = super::common::figure(&report(sweep()), "bend", "theta_rmse_deg");
    // Twice the paper's mean residual of one sensor.
    assert!(found < 2.0 * 4.72, "{found}°");
}
