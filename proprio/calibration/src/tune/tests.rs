//! The gradient against finite differences, the objective against `replay`, and descent on functions that are known.

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, DriftToml, NoiseToml, StopReason};
use estimator_core::{
    ArmConfig, BendMap, BendSensorConfig, Estimator, FusedOps, ImuReading, KalmanParams, Method, Phase, Q,
    QuadraticMap, Sample, SegmentConfig,
};
use proprio_analysis::metrics::ErrorMetrics;
use proprio_analysis::replay::replay;
use proprio_session::{LoadedTable, NoProgress};
use proprio_simulation::{ImuColumns, SessionWriter, Simulation};
use rig_twin::{Layout, Scenario};

use super::descent::{MAX_ITERATIONS, descend};
use super::objective::{Evaluation, Objective};
use super::parameters::Ranges;
use super::search::{GridPoint, MAX_RUNS, filter_at, search};
use super::training::{Part, Training};
use super::{Dual, TuningError, pooled};

/// A simulated session; of `gaps`, some readings are missing and the camera sees no segment now and then.
fn session(folder: &Path, scenario: Scenario, rate_hz: f64, gaps: bool) -> PathBuf {
    let mut writer =
        SessionWriter::new(Vec::new(), &Layout::default(), ImuColumns::Deg).expect("memory can be written to");
    for (k, mut sample) in Simulation::new(scenario, 3, 60.0, rate_hz).expect("a valid run").enumerate() {
        if gaps && k % 7 == 0 {
            sample.counts[k % 12] = None;
            sample.counts[(k + 1) % 12] = None;
            sample.quaternions[(k / 7) % 6] = None;
        }
        writer.write(&sample).expect("memory can be written to");
    }
    let mut text = String::from_utf8(writer.into_inner()).expect("it is text");
    if gaps {
        let blind = |(k, line): (usize, &str)| match k % 5 {
            1 => line.rsplitn(4, ',').last().unwrap_or_default().to_owned() + ",,,\n",
            _ => line.to_owned() + "\n",
        };
        text = text.lines().enumerate().map(blind).collect();
    }
    let path = folder.join(format!("{scenario:?}-{rate_hz}-{gaps}.csv"));
    std::fs::write(&path, text).expect("a temporary folder can be written to");
    path
}

/// The reference table, which has the bias filter.
fn reference() -> LoadedTable<'static> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml"));
    LoadedTable { file: ArmFile::load(path).expect("it is committed"), path }
}

/// The reference table with the anchor, and with Kalman filters that remember, weigh and scale.
fn table() -> LoadedTable<'static> {
    let mut table = reference();
    (table.file.drift, table.file.uncertainty) = (None, None);
    for (i, segment) in (1..).map(f64::from).zip(&mut table.file.segments) {
        let keys =
            |r_imu| NoiseToml { q: 2e-3 * i, r_imu, r_bend: 1e-3, h_imu: 1.0 - 0.01 * i, h_bend: 1.0 + 0.02 * i };
        (segment.orient, segment.coord) = (Some(keys(3e-4 * i)), Some(keys(8e-4)));
    }
    table
}

fn objective(table: &LoadedTable, sessions: &[PathBuf]) -> Objective {
    let read = |path: &PathBuf| Training::read(path, Part::Both, table, &mut NoProgress).expect("a good session");
    let sessions = sessions.iter().map(read).collect();
    Objective::new(sessions, table.compile::<f64>(10.0).expect("a table").config().segments)
}

fn assert_gradient_is_exact(table: &LoadedTable, sessions: &[PathBuf]) {
    let objective = objective(table, sessions);
    let place = objective.place(&table.file);
    let exact = objective.at(&place).gradient;
    assert_eq!(exact.len(), 48);
    for k in 0..place.len() {
        // The loss has 1e-16 of rounding, and central differences leave h² of the third derivative.
        let h = 1e-4;
        let at = |by: f64| {
            let mut place = place.clone();
            place[k] += by;
            objective.at(&place).loss
        };
        let finite = (at(h) - at(-h)) / (2.0 * h);
        assert!((exact[k] - finite).abs() < 1e-9 + 1e-7 * finite.abs(), "{k}: {} instead of {finite}", exact[k]);
    }
    let acting = exact.iter().filter(|derivative| derivative.abs() > 1e-5).count();
    assert!(acting > 40, "only {acting} parameters act, so that this test shows little");
}

#[test]
fn the_gradient_of_a_session_is_that_of_finite_differences() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    assert_gradient_is_exact(&table(), &[session(folder.path(), Scenario::Push, 10.0, false)]);
}

#[test]
fn the_gradient_is_exact_over_sessions_of_two_rates_with_readings_and_truth_missing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sessions = [
        session(folder.path(), Scenario::FreeSwing, 10.0, true),
        session(folder.path(), Scenario::Obstacle, 25.0, true),
    ];
    assert_gradient_is_exact(&table(), &sessions);
}

fn assert_errors_are_those_of_replay(table: &LoadedTable) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = session(folder.path(), Scenario::FreeSwing, 10.0, true);
    let mut errors = ErrorMetrics::new(table.file.length_mm());
    let visit = |row: &_, outcome: &_| {
        errors.add(row, outcome);
        Ok(())
    };
    replay::<f64>(&path, table, &mut NoProgress, visit).expect("a good session");
    let [.., fusion] = errors.metrics();

    let found = objective(table, &[path]).of_table(&table.file);
    let mut errors = pooled(&found, |session| &session.training);
    errors.append(&pooled(&found, |session| &session.validation));
    let (found, expected) = (errors.keys().tip_rmse_mm, fusion.tip_rmse_mm.expect("there is truth"));
    assert!((found - expected).abs() < 1e-9 * expected, "{found} instead of {expected}");
}

#[test]
fn the_errors_are_those_of_replay() {
    assert_errors_are_those_of_replay(&reference());
}

#[test]
fn the_errors_with_the_anchor_are_those_of_replay() {
    assert_errors_are_those_of_replay(&table());
}

#[test]
fn of_three_sessions_the_third_judges_and_of_two_the_last_fifths() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = session(folder.path(), Scenario::FreeSwing, 10.0, false);
    let counts = |count: usize| -> Vec<[u64; 2]> {
        let sessions = (0..count).map(|k| {
            let training = Training::read(&path, Part::of_session(k, count), &reference(), &mut NoProgress)
                .expect("a good session");
            let errors = training.fused().expect("it has the bias filter");
            [errors.training.tips.count(), errors.validation.tips.count()]
        });
        sessions.collect()
    };
    assert_eq!(counts(2), [[480, 120]; 2]);
    assert_eq!(counts(4), [[600, 0], [600, 0], [0, 600], [600, 0]]);
}

/// The bias filter bypasses the Kalman filters.
#[test]
fn the_errors_with_the_bias_filter_do_not_depend_on_the_kalman_filters() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sessions = [session(folder.path(), Scenario::FreeSwing, 10.0, true)];
    let (bare, mut filtered) = (reference(), reference());
    filtered.file.segments = table().file.segments;
    assert_ne!(bare.file.segments, filtered.file.segments);
    let [bare, filtered] = [bare, filtered].map(|table| objective(&table, &sessions).of_table(&table.file));
    assert_eq!(bare.sessions, filtered.sessions);
}

#[test]
fn a_place_is_worth_what_its_table_is() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let table = table();
    let objective = objective(&table, &[session(folder.path(), Scenario::FreeSwing, 10.0, false)]);
    let place = objective.place(&table.file);
    let tables = [table.file.clone(), objective.table(&place, table.file.clone())];
    for of_table in tables.map(|table| objective.of_table(&table)) {
        assert!((of_table.loss - objective.at(&place).loss).abs() < 1e-12);
        assert!((of_table.validation_loss - objective.at(&place).validation_loss).abs() < 1e-12);
    }
}

/// However far descent goes, the table is one that the format and fixed point take.
#[test]
fn every_place_is_a_table_in_which_fixed_point_keeps_its_digits() {
    let ranges = Ranges::new(10.0);
    let ends = [-1e6, -3.0, 0.0, 3.0, 1e6];
    for (r, q) in ends.into_iter().flat_map(|r| ends.map(|q| (r, q))) {
        for (h, r_bend) in ends.into_iter().flat_map(|h| [1e-12, 1e-6, 1e-3, 1e6].map(|r_bend| (h, r_bend))) {
            let keys = ranges.keys(&[r, q, h, -h], r_bend);
            let mut file = table().file;
            file.segments[2].coord = Some(keys);
            let file = ArmFile::parse(&file.to_toml()).unwrap_or_else(|error| panic!("{r} {q} {h} {r_bend}: {error}"));
            for rate_hz in [10.0, 100.0] {
                let compiled = file.compile::<Q>(rate_hz).expect("a table");
                let noise = compiled.config().segments[2].coord;
                assert!(noise.q.to_f64() > 0.999e-3, "{r} {q}: {} a sample", noise.q.to_f64());
            }
        }
    }
}

/// A point that is 1 in each coordinate, at the bottom of a valley with curvatures from 1 to 100.
fn valley(place: &[f64]) -> Evaluation {
    let curvature = |k: usize| if k == 0 { 100.0 } else { 1.0 };
    let off = place.iter().map(|x| x - 1.0).enumerate();
    let loss = off.clone().map(|(k, off)| 0.5 * curvature(k) * off * off).sum();
    let gradient = off.map(|(k, off)| curvature(k) * off).collect();
    Evaluation { loss, gradient, ..Evaluation::default() }
}

#[test]
fn descent_finds_the_bottom_of_a_valley() {
    let mut last = Vec::new();
    let stopped = descend(valley, vec![3.0, -4.0, 0.5], |iterate| {
        last.clone_from(&iterate.place);
        true
    });
    assert_eq!(stopped, Ok(StopReason::Converged));
    assert!(last.iter().all(|x| (x - 1.0).abs() < 1e-2), "{last:?}");
}

#[test]
fn descent_is_given_up_where_there_is_no_bottom() {
    let slope = |place: &[f64]| Evaluation { loss: -place[0], gradient: vec![-1.0], ..Evaluation::default() };
    let mut iterations = 0;
    let stopped = descend(slope, vec![0.0], |iterate| {
        iterations = iterate.number;
        true
    });
    assert_eq!((stopped, iterations), (Err(TuningError::NotConverged { iterations: MAX_ITERATIONS }), MAX_ITERATIONS));
}

#[test]
fn descent_ends_when_it_is_told_to() {
    let stopped = descend(valley, vec![3.0, -4.0], |iterate| iterate.number < 2);
    assert_eq!(stopped, Ok(StopReason::Interrupted));
}

#[test]
fn errors_that_are_no_numbers_are_refused() {
    let nothing = |_: &[f64]| Evaluation { loss: f64::NAN, gradient: vec![0.0], ..Evaluation::default() };
    assert_eq!(descend(nothing, vec![0.0], |_| true), Err(TuningError::NotFinite));
    let steep = |_: &[f64]| Evaluation { loss: 1.0, gradient: vec![f64::INFINITY], ..Evaluation::default() };
    assert_eq!(descend(steep, vec![0.0], |_| true), Err(TuningError::NotFinite));
}

/// Evaluation of a point by its distance from the bottom of a bowl, in decades.
fn bowl(place: &GridPoint, bottom: [f64; 5], depth: f64) -> Evaluation {
    let off = place.iter().zip(bottom).map(|(steps, bottom)| f64::from(*steps) / 8.0 - bottom);
    Evaluation { loss: depth * off.map(|off| off * off).sum::<f64>(), ..Evaluation::default() }
}

#[test]
fn the_search_finds_the_bottom_of_a_bowl_to_a_factor_of_1_3() {
    let bottom = [-0.7, 0.45, 0.3, 0.0, -0.2];
    let mut runs = 0;
    let finds = search(bowl(&[0; 5], bottom, 10.0), |place| {
        runs += 1;
        Some(bowl(place, bottom, 10.0))
    });
    let place = finds.last().expect("there is a better place").place;
    assert!(place.iter().zip(bottom).all(|(steps, at)| (f64::from(*steps) / 8.0 - at).abs() <= 0.125), "{place:?}");
    assert!(runs <= MAX_RUNS, "{runs}");
}

#[test]
fn the_search_keeps_within_a_decade() {
    let bottom = [-3.0, 3.0, -3.0, 0.0, 0.0];
    let mut finds = search(bowl(&[0; 5], bottom, 10.0), |place| Some(bowl(place, bottom, 10.0)));
    assert_eq!(finds.pop().expect("there are better places").place, [-8, 8, -8, 0, 0]);
}

/// A fifth of a percent for a decade is not worth the way.
#[test]
fn the_search_stays_where_there_is_little_to_win() {
    let bottom = [1.0, -1.0, 1.0, 0.5, -0.5];
    assert!(search(bowl(&[0; 5], bottom, 0.002), |place| Some(bowl(place, bottom, 0.002))).is_empty());
}

#[test]
fn the_search_ends_when_it_is_told_to_and_has_the_best_so_far() {
    let bottom = [1.0, 0.0, 0.0, 0.0, 0.0];
    // Ten neighbours, and one of the next place's.
    let mut left = 11;
    let finds = search(bowl(&[0; 5], bottom, 10.0), |place| {
        left -= 1;
        (left > 0).then(|| bowl(place, bottom, 10.0))
    });
    assert_eq!((finds.len(), finds[0].place, left), (1, [8, 0, 0, 0, 0], 0));
}

#[test]
fn a_bias_filter_at_any_place_is_one_that_the_format_takes() {
    for start in [
        DriftToml {
            rate_deg_per_s: 1e-4,
            rate_random_walk_deg_per_s_sqrt_s: 1e-5,
            offset_deg: 0.0,
            ..DriftToml::kalman()
        },
        DriftToml {
            rate_deg_per_s: 0.2,
            rate_random_walk_deg_per_s_sqrt_s: 0.01,
            offset_deg: 20.0,
            ..DriftToml::kalman()
        },
    ] {
        for place in [[-8, -8, -8, 0, -8], [8; 5]] {
            let file = ArmFile { drift: Some(filter_at(&start, &place)), ..table().file };
            assert_eq!(ArmFile::parse(&file.to_toml()).expect("it is in range"), file);
        }
    }
}

/// Fusion's tip after two seconds of bending, for filters with this R_imu.
fn tip<S: FusedOps>(r_imu: S) -> [S; 2] {
    let one = S::one();
    let noise = KalmanParams { q: S::from_f64(0.2), r_imu, r_bend: one, h_imu: one, h_bend: one };
    let map = BendMap::Quadratic(QuadraticMap::from_volts(0.1, 1.2, -2.0, [0.5, 2.5]));
    let bend = [Some(BendSensorConfig { map, memory: None }); 2];
    let segment = SegmentConfig { bend, orient: noise, coord: noise, ..SegmentConfig::uncalibrated(0.080, 0.017) };
    let segments = [segment; 3];
    let table = ArmConfig::uncalibrated(&segments);
    let mut estimator = Estimator::<S, 3, 100>::new(&table).expect("a valid table");
    let mut ends = [S::zero(); 2];
    for k in 0..20_u16 {
        let mut sample = Sample::missing(u64::from(k) * 100_000);
        for i in 0..3 {
            sample.bend[i] = [Some(1800 + 10 * k), Some(1850 + 9 * k)];
            sample.imu[i] = Some(ImuReading::Heading(Phase::from_degrees(f64::from(k) * (i + 1) as f64)));
        }
        let estimate = estimator.update_full(&sample);
        let end = estimator.shape(&estimate, Method::Fusion)[2].end.expect("the filters have begun");
        ends = [end.x, end.y];
    }
    ends
}

#[test]
fn a_derivative_through_the_whole_estimator_is_that_of_finite_differences() {
    let (r_imu, h) = (0.3, 1e-5);
    let exact = tip(Dual::new(r_imu, 1.0));
    let (above, below) = (tip(r_imu + h), tip(r_imu - h));
    for axis in 0..2 {
        let finite = (above[axis] - below[axis]) / (2.0 * h);
        // Central differences leave h² of the third derivative and rounding over h: 1e-9 here.
        let exact = exact[axis].derivative();
        assert!((exact - finite).abs() < 1e-8, "axis {axis}: {exact} instead of {finite}");
        assert!(finite.abs() > 1e-4, "axis {axis}: the tip depends on the parameter");
    }
}
