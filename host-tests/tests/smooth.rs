//! Smoothed estimates of arms of the twin, as calibrated on their own sweeps.

use std::path::Path;

use calibration_tables::ArmFile;
use host_tests::parallel::in_parallel;
use host_tests::twin::{TwinSession, replay_smoothed};
use proprio::calibrate::{CalibrationOptions, calibrate};
use proprio::output::OutputFile;
use proprio::replay::NamedTable;
use proprio::score::Score;
use proprio::session::{ImuColumns, SessionWriter};
use proprio::simulate::Simulation;
use rig_twin::{Motion, Scenario, Setup};

const ARMS: [u64; 6] = [1, 2, 3, 4, 5, 6];
const SCENARIOS: [Scenario; 3] = [Scenario::One, Scenario::Two, Scenario::Three];

fn setup(arm_seed: u64, scenario: Scenario, seed: u64) -> Setup {
    Setup { arm_seed, scenario, motion: Motion::Swings, seed: 100 * arm_seed + seed }
}

/// The table of an arm's own sweep.
fn table(arm_seed: u64, folder: &Path) -> ArmFile {
    let sweep = folder.join(format!("sweep-{arm_seed}.csv"));
    let file = OutputFile::create(&sweep, &[]).expect("a temporary folder can be written to");
    let mut writer = SessionWriter::new(file, ImuColumns::Quaternion).expect("a temporary file can be written");
    let samples = Simulation::of(&setup(arm_seed, Scenario::Sweep, 0), 900.0, 10.0).expect("a rate and a duration");
    samples.for_each(|sample| writer.write(&sample).expect("a temporary file can be written"));
    writer.into_inner().finish().expect("a temporary file can be renamed");
    let arm = Path::new(env!("CARGO_MANIFEST_DIR")).join("../calibration-tables/arms/planar-6.toml");
    let arm = NamedTable::load(&arm).expect("the reference arm's description");
    calibrate(&[sweep], &arm, CalibrationOptions::default()).expect("a sweep calibrates").table
}

/// RMSE of the tip by fusion and smoothed, mm, and the share of true tips inside the smoothed ellipses, %.
fn figures(table: &ArmFile, setup: &Setup) -> [f64; 3] {
    let session = TwinSession::new(setup, 900.0, 10.0).expect("a rate and a duration");
    let mut score = Score::new(table.length_mm());
    replay_smoothed(table, 10.0, || session.rows(), |row, outcome| score.add(row, outcome)).expect("a table");
    let smoothed = score.smoothed().expect("there is truth");
    let inside = smoothed.uncertainty.and_then(|uncertainty| uncertainty.tip_inside_percent);
    [score.figures()[3].tip_rmse_mm, smoothed.figures.tip_rmse_mm, inside].map(|figure| figure.expect("there is truth"))
}

#[test]
fn on_arms_of_the_twin_smoothed_tips_are_nearer_to_the_truth_and_their_ellipses_hold() {
    let folder = tempfile::tempdir().expect("there is room for a temporary folder");
    let of_arm = |seed: &u64| {
        let table = table(*seed, folder.path());
        (1..).zip(SCENARIOS).map(|(k, scenario)| figures(&table, &setup(*seed, scenario, k))).collect::<Vec<_>>()
    };
    let all: Vec<[f64; 3]> = in_parallel(&ARMS, of_arm).into_iter().flatten().collect();
    let [fusion, smoothed, inside] =
        [0, 1, 2].map(|k| all.iter().map(|figures| figures[k]).sum::<f64>() / all.len() as f64);
    assert!(smoothed < 0.85 * fusion, "mean of {smoothed} mm, {fusion} mm by fusion: {all:?}");
    assert!(inside >= 88.0, "mean of {inside} % inside: {all:?}");
}
