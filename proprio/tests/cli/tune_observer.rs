//! `tune` beyond the filters: the drift observer's own parameters, and the variances.

use calibration_tables::{ArmFile, DriftKeys, ObserverTuningKeys, TuningKeys, UncertaintyKeys};

use super::common::{Csv, Folder, figure, json, simulate, table};
use super::tune::{TUNE, load, training};

/// The reference table with an observer, and with what errors come from.
pub fn observing(drift: DriftKeys, uncertainty: Option<UncertaintyKeys>) -> String {
    let mut file = load(table());
    (file.drift, file.uncertainty) = (Some(drift), uncertainty);
    file.to_toml()
}

/// An observer for bend sensors a hundred times as noisy as they are: it hardly learns.
fn timid() -> DriftKeys {
    DriftKeys { noise_deg2_s: 5000.0, ..DriftKeys::observer() }
}

/// Deviations for which the errors are too large, or too small, by this factor.
fn deviations(factor: f64) -> UncertaintyKeys {
    let [theta_deg, drift_share, bend_deg, contact_deg, heading_deg, end_mm] =
        [0.1, 0.1, 3.0, 0.5, 0.6, 0.5].map(|key| key * factor);
    UncertaintyKeys { theta_deg, drift_share, bend_deg, contact_deg, heading_deg, end_mm }
}

/// A folder with the table before and after, and its record.
fn tuned(session: &Csv, table: String) -> (Folder, ArmFile, TuningKeys) {
    let folder = Folder::with("session.csv", session.to_string());
    folder.write("table.toml", table);
    folder.done(&TUNE);
    let file = load(folder.path("tuned.toml"));
    let record = file.tuning.clone().expect("a tuned table has a record");
    (folder, file, record)
}

#[test]
fn an_observer_that_hardly_learns_becomes_a_better_one_for_other_runs_of_its_kind_too() {
    let session = simulate("--scenario 1 --seconds 300 --seed 55");
    let (folder, file, record) = tuned(&session, observing(timid(), None));
    let drift = file.drift.expect("it has an observer");
    let ObserverTuningKeys { noise_deg2_s, walk_deg_per_s, slope, runs } = record.observer.expect("it was tuned");
    assert_eq!(noise_deg2_s.map(f64::to_bits), [5000.0, drift.noise_deg2_s].map(f64::to_bits));
    assert_eq!(walk_deg_per_s.map(f64::to_bits), [2e-4, drift.walk_deg_per_s].map(f64::to_bits));
    assert_eq!(slope.map(f64::to_bits), [0.15, drift.slope].map(f64::to_bits));
    assert!((500.0..5000.0).contains(&drift.noise_deg2_s), "better, and within a decade: {}", drift.noise_deg2_s);
    assert!((1..=60).contains(&runs), "{runs} runs");

    folder.write("observer.toml", observing(drift, None));
    for seed in ["12", "13", "14"] {
        folder.done(&["simulate", "--scenario", "1", "--seconds", "300", "--seed", seed, "-o", "unseen.csv"]);
        let rmse_mm = |table| {
            let report = json(&folder.done(&["replay", "unseen.csv", "--table", table, "--json"]));
            figure(&report, "fusion", "tip_rmse_mm")
        };
        let (before, after) = (rmse_mm("table.toml"), rmse_mm("observer.toml"));
        assert!(after < before, "seed {seed}: {after} mm, and {before} mm before");
    }
}

#[test]
fn the_observer_before_and_after_is_printed() {
    let folder = Folder::with("session.csv", training().to_string());
    folder.write("table.toml", observing(timid(), Some(deviations(1.0))));
    let stdout = folder.done(&TUNE).stdout;
    let line = stdout.lines().find(|line| line.trim_start().starts_with("noise_deg2_s")).expect("a line of its own");
    assert!(line.contains("5.000e3"), "{stdout}");
    assert!(stdout.contains("runs of the estimator") && stdout.contains("variances are "), "{stdout}");
}

/// Truth that the old observer meets while it is held back: whatever is better before is worse there.
#[test]
fn an_observer_that_is_worse_on_what_is_held_back_is_not_kept() {
    let mut session = simulate("--scenario 1 --seconds 300 --seed 55");
    let before = observing(timid(), None);
    let folder = Folder::with("session.csv", session.to_string());
    folder.write("table.toml", &before);
    folder.done(&["replay", "session.csv", "--table", "table.toml", "--out", "est.csv", "--float"]);
    session.follow(&folder.csv("est.csv"), session.rows.len() - session.rows.len() / 5);
    let (_, file, record) = tuned(&session, before);
    assert_eq!(file.drift, Some(timid()));
    assert!(record.observer.is_some_and(|observer| observer.runs > 1), "others were tried");
}

#[test]
fn a_table_with_the_anchor_has_no_more_than_its_filters_tuned() {
    let (folder, file, record) = tuned(&training(), super::tune::spoiled());
    assert_eq!((record.observer, record.variances, file.drift, file.uncertainty), (None, None, None, None));
    assert!(!folder.read("tuned.toml").contains("observer"));
}

/// `replay` on the part that is not held back finds the factor.
#[test]
fn variances_that_are_too_small_grow_by_one_factor_to_what_the_errors_are() {
    let small = deviations(0.1);
    let mut session = training();
    let (folder, mut file, record) = tuned(&session, observing(DriftKeys::observer(), Some(small.clone())));
    let factor = record.variances.expect("the table says what errors come from");
    let grown = file.uncertainty.replace(small.clone()).expect("it still does");
    assert!(factor > 1.0, "{factor}");
    for (before, after, by) in [
        (small.theta_deg, grown.theta_deg, factor.sqrt()),
        (small.drift_share, grown.drift_share, factor),
        (small.bend_deg, grown.bend_deg, factor.sqrt()),
        (small.contact_deg, grown.contact_deg, factor.sqrt()),
        (small.heading_deg, grown.heading_deg, factor.sqrt()),
        (small.end_mm, grown.end_mm, factor.sqrt()),
    ] {
        assert!((after / before / by - 1.0).abs() < 1e-12, "{before} became {after}, expected {by} times as much");
    }

    session.rows.truncate(session.rows.len() - session.rows.len() / 5);
    folder.write("seen.csv", session.to_string());
    folder.write("narrow.toml", file.to_toml());
    let report = json(&folder.done(&["replay", "seen.csv", "--table", "narrow.toml", "--json", "--float"]));
    let nees = report["all"]["uncertainty"]["end_nees"].as_f64().expect("there are truth and covariances");
    assert!((nees / factor - 1.0).abs() < 1e-12, "{nees}, and the factor is {factor}");
}

#[test]
fn variances_that_are_too_large_stay_as_they_are() {
    let large = deviations(2.0);
    let (_, file, record) = tuned(&training(), observing(DriftKeys::observer(), Some(large.clone())));
    assert_eq!((file.uncertainty, record.variances), (Some(large), Some(1.0)));
}

#[test]
fn variances_grow_no_further_than_a_table_may_say() {
    let tiny = UncertaintyKeys { contact_deg: 8.9, ..deviations(1e-3) };
    let (_, file, _) = tuned(&training(), observing(DriftKeys::observer(), Some(tiny)));
    assert!(file.uncertainty.is_some_and(|keys| keys.contact_deg <= 9.0 && keys.end_mm > 5e-4));
}
