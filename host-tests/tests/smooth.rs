//! Smoothed estimates of arms of the twin, as calibrated on their own sweeps.

use std::path::Path;

use calibration_tables::ArmFile;
use host_tests::parallel::in_parallel;
use host_tests::twin::{TwinSession, replay_smoothed};
use proprio_analysis::metrics::ErrorMetrics;
use proprio_calibration::calibrate::{CalibrationOptions, calibrate};
use proprio_session::{Existing, LoadedTable, NoProgress, OutputFile};
use proprio_simulation::{ImuColumns, SessionWriter, Simulation};
use rig_twin::{Scenario, Setup};

const ARMS: [u64; 6] = [1, 2, 3, 4, 5, 6];
const SCENARIOS: [Scenario; 3] = [Scenario::FreeSwing, Scenario::Push, Scenario::Obstacle];

fn setup(arm_seed: u64, scenario: Scenario, seed: u64) -> Setup {
    Setup { arm_seed, ..Setup::new(scenario, 100 * arm_seed + seed) }
}

/// The table of an arm's own sweep.
fn table(arm_seed: u64, folder: &Path) -> ArmFile {
    let sweep = folder.join(format!("sweep-{arm_seed}.csv"));
    let file = OutputFile::create(&sweep, &[], Existing::Keep).expect("a temporary folder can be written to");
    let setup = setup(arm_seed, Scenario::Sweep, 0);
    let writer = SessionWriter::new(file, &setup.layout, ImuColumns::Quaternion);
    let mut writer = writer.expect("a temporary file can be written");
    let samples = Simulation::of(&setup, 900.0, 10.0).expect("a rate and a duration");
    samples.for_each(|sample| writer.write(&sample).expect("a temporary file can be written"));
    writer.into_inner().finish().expect("a temporary file can be renamed");
    let arm = Path::new(env!("CARGO_MANIFEST_DIR")).join("../calibration-tables/arms/planar-6.toml");
    let arm = LoadedTable::load(&arm).expect("the reference arm's description");
    calibrate(&[sweep], &arm, CalibrationOptions::default(), &mut NoProgress).expect("a sweep calibrates").table
}

/// RMSE of the tip by fusion and smoothed, mm, and the share of true tips inside the smoothed ellipses, %.
fn figures(table: &ArmFile, setup: &Setup) -> [f64; 3] {
    let session = TwinSession::new(setup, 900.0, 10.0).expect("a rate and a duration");
    let mut score = ErrorMetrics::new(table.length_mm());
    replay_smoothed(table, 10.0, || session.rows(), |row, outcome| score.add(row, outcome)).expect("a table");
    let smoothed = score.smoothed().expect("there is truth");
    let inside = smoothed.uncertainty.and_then(|uncertainty| uncertainty.tip_inside_percent);
    [score.metrics()[3].tip_rmse_mm, smoothed.metrics.tip_rmse_mm, inside].map(|figure| figure.expect("there is truth"))
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

/// The covariance in floats is computed from the estimator's operations alone; at the end of a session nothing smooths it.
#[test]
fn the_last_estimate_of_a_session_is_that_of_the_estimator_with_its_covariance() {
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("../calibration-tables/planar-6.toml");
    let table = ArmFile::load(&table).expect("the reference table");
    let session = TwinSession::new(&setup(0, Scenario::Push, 2), 900.0, 10.0).expect("a rate and a duration");
    for length in [300, 2048, 2049, 4000, 6500, 9000] {
        let mut last = None;
        let rows = || session.rows().take(length);
        replay_smoothed(&table, 10.0, rows, |_, outcome| last = Some(outcome.clone())).expect("a table");
        let last = last.expect("there are rows");
        let smoothed = last.smoothed.expect("it was smoothed");
        let [fusion, smoothed_tip] = [&last.shapes[3], &smoothed.shape]
            .map(|shape| shape.last().and_then(|segment| segment.end).expect("all readings are there"));
        let apart_m = (fusion.x.to_f64() - smoothed_tip.x.to_f64()).hypot(fusion.y.to_f64() - smoothed_tip.y.to_f64());
        let [expected, found] = [&last.uncertainties, &smoothed.uncertainties].map(|uncertainties| {
            let tip =
                uncertainties.last().and_then(|uncertainty| uncertainty.end).expect("the table has error sources");
            let [xx, _, yy] = tip.square_metres();
            (xx + yy).sqrt()
        });
        // The last row's own update is not in the estimator's shape, but in its covariance.
        assert!(apart_m < 0.2 * expected, "{} mm after {length} rows", apart_m * 1e3);
        assert!((found / expected - 1.0).abs() < 0.03, "{found} m for {expected} m after {length} rows");
    }
}
