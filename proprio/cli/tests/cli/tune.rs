//! `tune` on good sessions: the tuned table, its report, and the end of a run.

use std::path::Path;
use std::sync::OnceLock;

use calibration_tables::{ArmFile, NoiseToml, StopReason, TuningToml};

use super::common::{Csv, Folder, Run, figure, json, simulate, table};

/// 90 s of free swings.
pub fn training() -> Csv {
    static SESSION: OnceLock<Csv> = OnceLock::new();
    SESSION.get_or_init(|| simulate("--scenario 1 --seconds 90 --seed 52")).clone()
}

/// The reference table with the anchor.
fn with_anchor() -> ArmFile {
    let mut file = load(table());
    (file.drift, file.uncertainty) = (None, None);
    file
}

/// The reference table with the anchor, and with filters that trust both sensors alike and remember much.
pub fn spoiled() -> String {
    let mut file = with_anchor();
    for segment in &mut file.segments {
        let noise = NoiseToml { q: 2e-3, r_imu: 1e-3, r_bend: 1e-3, h_imu: 0.98, h_bend: 1.03 };
        (segment.orient, segment.coord) = (Some(noise.clone()), Some(noise));
    }
    file.to_toml()
}

pub fn load(path: impl AsRef<Path>) -> ArmFile {
    ArmFile::load(path.as_ref()).expect("a valid table")
}

pub const TUNE: [&str; 6] = ["tune", "session.csv", "--table", "table.toml", "-o", "tuned.toml"];

/// A tuning of [`training`].
struct Tuned {
    folder: Folder,
    run: Run,
}

impl Tuned {
    fn new(table: &str) -> Self {
        let folder = Folder::with("session.csv", training().to_string());
        folder.write("table.toml", table);
        let run = folder.done(&TUNE);
        Self { folder, run }
    }

    fn file(&self) -> ArmFile {
        load(self.folder.path("tuned.toml"))
    }

    fn record(&self) -> TuningToml {
        self.file().tuning.expect("a tuned table has a record")
    }
}

#[test]
fn a_spoiled_tables_errors_fall_and_those_held_back_as_well() {
    let TuningToml { before, after, validation_before, validation_after, stop_reason, .. } =
        Tuned::new(&spoiled()).record();
    for (before, after) in [(before, after), (validation_before, validation_after)] {
        assert!(after.position_rmse_mm < 0.7 * before.position_rmse_mm, "{before:?} {after:?}");
        assert!(after.tip_rmse_mm < 0.7 * before.tip_rmse_mm, "{before:?} {after:?}");
        assert!(after.heading_rmse_deg < 0.9 * before.heading_rmse_deg, "{before:?} {after:?}");
    }
    assert_eq!(stop_reason, StopReason::Converged);
}

/// Checks that the record's tip RMSE of the two parts comes together to what `replay --float` finds with both tables.
pub fn assert_record_is_what_replay_finds(folder: &Folder, session: &Csv) {
    let record = load(folder.path("tuned.toml")).tuning.expect("a tuned table has a record");
    let rows = session.rows.len() as f64;
    let held_back = (rows / 5.0).floor();
    for (name, seen, held) in
        [("table.toml", record.before, record.validation_before), ("tuned.toml", record.after, record.validation_after)]
    {
        let squares = (rows - held_back) * seen.tip_rmse_mm.powi(2) + held_back * held.tip_rmse_mm.powi(2);
        let expected = (squares / rows).sqrt();
        let report = json(&folder.done(&["replay", "session.csv", "--table", name, "--json", "--float"]));
        let found = figure(&report, "fusion", "tip_rmse_mm");
        assert!((found - expected).abs() < 1e-9, "{name}: {found}, expected {expected}");
    }
}

#[test]
fn the_record_is_what_replay_finds() {
    assert_record_is_what_replay_finds(&Tuned::new(&spoiled()).folder, &training());
}

#[test]
fn nothing_but_the_filters_and_the_record_changes() {
    let tuned = Tuned::new(&spoiled());
    let (mut before, mut after) = (load(tuned.folder.path("table.toml")), tuned.file());
    assert!(before.segments.iter().zip(&after.segments).all(|(a, b)| a.orient != b.orient && a.coord != b.coord));
    for file in [&mut before, &mut after] {
        file.tuning = None;
        file.segments.iter_mut().for_each(|segment| (segment.orient, segment.coord) = (None, None));
    }
    assert_eq!(before, after);
}

#[test]
fn the_record_names_the_sessions_in_their_order() {
    let folder = Folder::with("b.csv", training().to_string());
    folder.write("a.csv", simulate("--scenario 2 --seconds 300 --seed 53").to_string());
    folder.done(&["tune", "b.csv", "a.csv", "--table", table(), "-o", "tuned.toml"]);
    let record = load(folder.path("tuned.toml")).tuning.expect("a record");
    assert_eq!(record.sessions, ["b.csv", "a.csv"]);
}

#[test]
fn the_figures_and_the_time_of_an_iteration_are_printed() {
    let tuned = Tuned::new(&spoiled());
    let (record, stdout) = (tuned.record(), &tuned.run.stdout);
    let parts = [record.before, record.after, record.validation_before, record.validation_after];
    let line = |name: &str| {
        let line = stdout.lines().find(|line| line.trim_start().starts_with(name));
        line.unwrap_or_else(|| panic!("no line {name}: {stdout}")).to_owned()
    };
    for rmse in parts {
        assert!(line("tip, mm").contains(&format!("{:.2}", rmse.tip_rmse_mm)), "{stdout}");
        assert!(line("all ends, mm").contains(&format!("{:.2}", rmse.position_rmse_mm)), "{stdout}");
        assert!(line("headings, deg").contains(&format!("{:.2}", rmse.heading_rmse_deg)), "{stdout}");
    }
    let end = line("converged after");
    assert!(end.contains(&format!("after {} iterations of ", record.iterations)), "{end}");
    assert_eq!(tuned.run.warnings().len(), 0, "nothing to warn of: {}", tuned.run.stderr);
}

#[test]
fn the_same_sessions_give_the_same_bytes() {
    let folder = Folder::with("a.csv", training().to_string());
    folder.write("b.csv", simulate("--scenario 2 --seconds 300 --seed 53").to_string());
    let tune = |name: &str| {
        folder.done(&["tune", "a.csv", "b.csv", "--table", table(), "-o", name]);
        folder.read(name)
    };
    assert_eq!(tune("one.toml"), tune("other.toml"));
}

#[test]
fn a_tuned_table_is_as_good_as_it_gets() {
    let tuned = Tuned::new(&spoiled());
    tuned.folder.done(&["tune", "session.csv", "--table", "tuned.toml", "-o", "again.toml"]);
    let again = load(tuned.folder.path("again.toml")).tuning.expect("a record");
    let gain = 1.0 - again.after.position_rmse_mm / again.before.position_rmse_mm;
    assert!(gain.abs() < 2e-3, "{gain} of the error: {again:?}");
}

#[test]
fn a_table_with_the_anchor_and_without_filters_gets_some() {
    let mut file = with_anchor();
    file.segments.iter_mut().for_each(|segment| (segment.orient, segment.coord) = (None, None));
    let tuned = Tuned::new(&file.to_toml());
    assert!(tuned.file().segments.iter().all(|segment| segment.orient.is_some() && segment.coord.is_some()));
    assert!(tuned.record().validation_after.tip_rmse_mm < tuned.record().validation_before.tip_rmse_mm);
}

#[test]
fn a_calibration_of_a_tuned_table_forgets_the_tuning() {
    let tuned = Tuned::new(&spoiled());
    tuned.folder.write("sweep.csv", super::common::sweep().to_string());
    tuned.folder.done(&["calibrate", "sweep.csv", "--arm", "tuned.toml", "-o", "anew.toml"]);
    assert_eq!(load(tuned.folder.path("anew.toml")).tuning, None);
}

/// Truth that the old filters meet to a thousandth of a degree in the validation part: any other filters are worse there.
#[test]
fn filters_that_are_worse_on_what_is_held_back_are_not_kept() {
    let mut session = training();
    let folder = Folder::with("session.csv", session.to_string());
    folder.write("table.toml", spoiled());
    folder.done(&["replay", "session.csv", "--table", "table.toml", "--out", "est.csv", "--float"]);
    let estimates = folder.csv("est.csv");
    let held_back_from = session.rows.len() - session.rows.len() / 5;
    session.follow(&estimates, held_back_from);
    folder.write("session.csv", session.to_string());
    let run = folder.done(&TUNE);
    let (before, after) = (load(folder.path("table.toml")), load(folder.path("tuned.toml")));
    let record = after.tuning.expect("a record");
    assert!(record.best_iteration == 0 && record.iterations > 0, "{record:?}");
    assert_eq!(before.segments, after.segments);
    assert!(run.stderr.starts_with("warning: ") && run.stderr.contains("validation error"), "{}", run.stderr);
    assert_eq!(run.warnings().len(), 1, "{}", run.stderr);
}

/// Tuned on free swings alone, the Kalman filters' fusion must be the best of all methods in each scenario, in runs that it
/// has not seen.
#[test]
fn a_tuned_fusion_with_the_anchor_is_better_than_any_other_method_in_every_scenario() {
    // The paper's method: quadratic maps, and filters of a calibration with the anchor.
    let mut paper = load(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-tests/tables/version-0.1.toml"));
    (paper.drift, paper.uncertainty) = (None, None);
    let folder = Folder::with("table.toml", paper.to_toml());
    folder.done(&["simulate", "--scenario", "1", "--seconds", "900", "--seed", "7", "-o", "session.csv"]);
    folder.done(&["tune", "session.csv", "--table", "table.toml", "-o", "tuned.toml"]);
    for scenario in ["1", "2", "3"] {
        let unseen = simulate(&format!("--scenario {scenario} --seconds 900 --seed 12"));
        folder.write("unseen.csv", unseen.to_string());
        let rmse = |table, method| {
            let report = json(&folder.done(&["replay", "unseen.csv", "--table", table, "--json"]));
            figure(&report, method, "tip_rmse_mm")
        };
        let tuned = rmse("tuned.toml", "fusion");
        for method in ["bend", "imu_o", "imu_c"] {
            assert!(tuned < rmse("tuned.toml", method), "{scenario}: fusion {tuned} mm, {method}");
        }
        assert!(tuned < rmse("table.toml", "fusion"), "{scenario}: {tuned} mm is better than before");
    }
}
