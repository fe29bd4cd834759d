//! Recorded sessions through the estimator, against committed estimates and against the float reference.
//!
//! `cargo xtask accept` records the sessions and the expected estimates again; see `README.md` here.

use std::fs;
use std::path::{Path, PathBuf};

use estimator_core::{FusedOps, Q};
use proprio_analysis::Outcome;
use proprio_analysis::estimates::{write_header, write_row};
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::replay;
use proprio_session::{LoadedTable, NoProgress};

const SESSIONS: [&str; 4] = ["scenario-1", "scenario-2", "scenario-3", "board-rate"];

/// Of this many rows one is kept in the expected estimates; the filters depend on the ones between.
const KEPT_ROWS: usize = 10;

/// Largest error of fixed point against the reference.
const Q_ERROR_RAD: f64 = 1e-6;
const Q_ERROR_M: f64 = 2e-6;

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn session(name: &str) -> PathBuf {
    here(&format!("sessions/{name}.csv"))
}

fn reference_table() -> PathBuf {
    here("../calibration-tables/planar-6.toml")
}

fn outcomes<S: FusedOps>(session: &Path) -> Vec<Outcome<S>> {
    let mut outcomes = Vec::new();
    let path = reference_table();
    let table = LoadedTable::load(&path).expect("the table is good");
    replay::<S>(session, &table, &mut NoProgress, |_, outcome| {
        outcomes.push(outcome.clone());
        Ok(())
    })
    .expect("the session is good");
    outcomes
}

fn check_expected(name: &str) {
    let outcomes = outcomes::<Q>(&session(name));
    let mut found = Vec::new();
    write_header(&mut found, 6, false).expect("memory takes all");
    for outcome in outcomes.iter().step_by(KEPT_ROWS) {
        write_row(&mut found, outcome).expect("memory takes all");
    }
    let found = String::from_utf8(found).expect("numbers are text");
    let path = here(&format!("expected/{name}.csv"));
    if std::env::var_os("PROPRIO_ACCEPT").is_some() {
        fs::write(&path, &found).expect("the expected estimates can be written");
    }
    let expected = fs::read_to_string(&path).expect("the expected estimates are committed");
    for (row, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
        assert_eq!(found, expected, "row {row} of {}", path.display());
    }
    assert_eq!(found.lines().count(), expected.lines().count());
}

#[test]
fn scenario_1_gives_the_expected_estimates() {
    check_expected("scenario-1");
}

#[test]
fn scenario_2_gives_the_expected_estimates() {
    check_expected("scenario-2");
}

#[test]
fn scenario_3_gives_the_expected_estimates() {
    check_expected("scenario-3");
}

#[test]
fn a_session_at_the_boards_rate_gives_the_expected_estimates() {
    check_expected("board-rate");
}

/// Largest differences of bend angle and world point between two estimates, rad and m.
fn differences(q: &Outcome<Q>, f: &Outcome<f64>) -> (f64, f64) {
    let (mut angle, mut point) = (0.0_f64, 0.0_f64);
    for (q, f) in q.shapes.iter().flatten().zip(f.shapes.iter().flatten()) {
        assert_eq!((q.theta.is_some(), q.end.is_some()), (f.theta.is_some(), f.end.is_some()), "both know the same");
        if let Some((q, f)) = q.theta.zip(f.theta) {
            angle = angle.max((q.rad() - f.rad()).abs());
        }
        if let Some((q, f)) = q.end.zip(f.end) {
            point = point.max((q.x.to_f64() - f.x).abs()).max((q.y.to_f64() - f.y).abs());
        }
    }
    (angle, point)
}

#[test]
fn fixed_point_stays_with_the_float_reference_in_every_session() {
    for name in SESSIONS {
        let (q, f) = (outcomes::<Q>(&session(name)), outcomes::<f64>(&session(name)));
        assert_eq!(q.len(), f.len());
        for (row, (q, f)) in q.iter().zip(&f).enumerate() {
            let (angle, point) = differences(q, f);
            assert!(angle < Q_ERROR_RAD, "{name}, sample {row}: {angle} rad");
            assert!(point < Q_ERROR_M, "{name}, sample {row}: {point} m");
        }
    }
}

#[test]
fn a_session_of_the_board_keeps_its_quaternions_to_the_bit() {
    let run = proprio_simulation::Simulation::new(rig_twin::Scenario::FreeSwing, 24, 10.0, 100.0).expect("a valid run");
    let recorded: Vec<_> = run.map(|sample| sample.quaternions).collect();
    let path = reference_table();
    let table = LoadedTable::load(&path).expect("the table is good");
    let mut rows = 0;
    replay::<Q>(&session("board-rate"), &table, &mut NoProgress, |row, _| {
        let recorded = recorded[rows].iter().flatten().map(|read| estimator_core::ImuReading::from_bno055(*read));
        assert!(row.sample.imu.iter().flatten().copied().eq(recorded), "sample {rows}");
        rows += 1;
        Ok(())
    })
    .expect("the session is good");
    assert_eq!(rows, recorded.len());
}

/// The kinematics alone, on a real arm with ideal orientations: the error of constant curvature.
#[test]
fn the_real_recording_misses_the_tip_by_the_known_floor() {
    let recording = here("../../shared/data/trunk-planar.csv");
    if !recording.exists() {
        println!("skipped: {} is not here; it is not part of the repository", recording.display());
        return;
    }
    let path = here("tables/trunk-planar.toml");
    let table = LoadedTable::load(&path).expect("the table is good");
    let mut score = ErrorMetrics::new(table.file.length_mm());
    replay::<Q>(&recording, &table, &mut NoProgress, |row, outcome| {
        score.add(row, outcome);
        Ok(())
    })
    .expect("the recording is good");
    let [bend, imu_o, _, _] = score.metrics();
    let rmse_mm = imu_o.tip_rmse_mm.expect("the recording has truth");
    assert!((rmse_mm - 9.25).abs() < 0.02, "{rmse_mm} mm");
    assert_eq!(bend.tip_rmse_mm, None, "the arm has no bend sensors");
}
