//! `[tuning]`, the record of a tuning: read and checked as strictly as all else, and no part of the parameters.

use calibration_tables::{ArmFile, DriftTuningToml, FileError, StopReason};
use estimator_core::Q;

use super::common::{TABLE, parse};

const TUNING: &str = r#"
[tuning]
sessions = ["a.csv", "b.csv"]
iterations = 12
best_iteration = 9
stop_reason = "interrupted"
covariance_inflation = 1.5
drift = { runs = 31, rate_deg_per_s = [0.05, 0.08], rate_random_walk_deg_per_s_sqrt_s = [2e-4, 1e-4], angle_random_walk_deg_per_sqrt_s = [0.01, 0.02], offset_deg = [1.0, 1.5], offset_s = [1500.0, 2000.0] }
before = { position_rmse_mm = 4.0, tip_rmse_mm = 8.0, heading_rmse_deg = 1.5 }
after = { position_rmse_mm = 3.0, tip_rmse_mm = 6.0, heading_rmse_deg = 1.25 }
validation_before = { position_rmse_mm = 5.0, tip_rmse_mm = 9.0, heading_rmse_deg = 2.0 }
validation_after = { position_rmse_mm = 4.5, tip_rmse_mm = 7.0, heading_rmse_deg = 1.75 }
"#;

fn tuned() -> String {
    format!("{TABLE}{TUNING}")
}

fn error(from: &str, to: &str) -> FileError {
    assert!(TUNING.contains(from), "{from} is not there");
    ArmFile::parse(&tuned().replacen(from, to, 1)).expect_err("it must be refused")
}

#[test]
fn every_key_is_read() {
    let tuning = parse(&tuned()).tuning.expect("it is in the file");
    assert_eq!(
        (tuning.sessions, tuning.iterations, tuning.best_iteration),
        (vec!["a.csv".to_owned(), "b.csv".to_owned()], 12, 9)
    );
    assert_eq!(tuning.stop_reason, StopReason::Interrupted);
    assert_eq!(tuning.covariance_inflation, Some(1.5));
    let drift = DriftTuningToml {
        runs: 31,
        rate_deg_per_s: [0.05, 0.08],
        rate_random_walk_deg_per_s_sqrt_s: [2e-4, 1e-4],
        angle_random_walk_deg_per_sqrt_s: [0.01, 0.02],
        offset_deg: [1.0, 1.5],
        offset_s: [1500.0, 2000.0],
    };
    assert_eq!(tuning.drift, Some(drift));
    let figures = [tuning.before, tuning.after, tuning.validation_before, tuning.validation_after]
        .map(|of| [of.position_rmse_mm, of.tip_rmse_mm, of.heading_rmse_deg].map(f64::to_bits));
    let expected = [[4.0, 8.0, 1.5], [3.0, 6.0, 1.25], [5.0, 9.0, 2.0], [4.5, 7.0, 1.75]];
    assert_eq!(figures, expected.map(|of| of.map(f64::to_bits)));
}

#[test]
fn the_bias_filter_and_the_variances_may_be_left_out() {
    let text = tuned();
    let filters = text.lines().filter(|line| !line.starts_with("covariance_inflation") && !line.starts_with("drift"));
    let lines: Vec<&str> = filters.collect();
    let tuning = parse(&lines.join("\n")).tuning.expect("it is in the file");
    assert_eq!((tuning.covariance_inflation, tuning.drift), (None, None));
}

#[test]
fn a_record_of_the_observer_of_version_0_1_is_accepted() {
    let observer =
        "observer = { runs = 31, noise_deg2_s = [50.0, 80.0], walk_deg_per_s = [2e-4, 1e-4], slope = [0.15, 0.25] }";
    let text = tuned().replace("covariance_inflation = 1.5", &format!("covariance_inflation = 1.5\n{observer}"));
    assert_eq!(parse(&text), parse(&tuned()));
}

#[test]
fn the_keys_of_version_0_1_are_accepted() {
    let mut text = tuned();
    for (new, old) in [
        ("best_iteration", "kept"),
        ("stop_reason", "stopped"),
        ("covariance_inflation", "variances"),
        ("validation_before", "held_back_before"),
        ("validation_after", "held_back_after"),
    ] {
        assert!(text.contains(new), "{new}");
        text = text.replace(new, old);
    }
    assert_eq!(parse(&text), parse(&tuned()));
}

#[test]
fn it_is_written_as_it_was_read() {
    let file = parse(&tuned());
    let text = file.to_toml();
    assert_eq!(parse(&text), file);
    for start in ["[tuning]", "sessions = [\"a.csv\", \"b.csv\"]", "before = { position_rmse_mm = 4.0, "] {
        assert!(text.lines().any(|line| line.starts_with(start)), "no line begins with {start}: {text}");
    }
}

/// The board reports its table by the checksum; a record is no part of the parameters.
#[test]
fn it_leaves_the_checksum_alone() {
    let checksum = |text: &str| parse(text).compile::<Q>(100.0).expect("a table").checksum();
    assert_eq!(checksum(&tuned()), checksum(TABLE));
}

#[test]
fn every_reason_to_stop_is_read_and_no_other() {
    for (name, reason) in [("converged", StopReason::Converged), ("interrupted", StopReason::Interrupted)] {
        let tuning = parse(&tuned().replace("interrupted", name)).tuning.expect("it is in the file");
        assert_eq!(tuning.stop_reason, reason);
    }
    assert!(error("interrupted", "tired").to_string().contains("tired"));
}

#[test]
fn a_key_that_is_missing_or_unknown_is_named() {
    assert!(error("best_iteration = 9\n", "").to_string().contains("`best_iteration`"));
    assert!(error("best_iteration", "best_iterate").to_string().contains("best_iterate"));
    assert!(error("tip_rmse_mm = 8.0", "tip_rmse = 8.0").to_string().contains("tip_rmse"));
}

#[test]
fn values_that_no_tuning_has_are_refused_with_their_key_and_line() {
    for (from, to, key) in [
        ("sessions = [\"a.csv\", \"b.csv\"]", "sessions = []", "tuning.sessions"),
        ("iterations = 12", "date = \"30.11.2026\"\niterations = 12", "tuning.date"),
        ("best_iteration = 9", "best_iteration = 13", "tuning.best_iteration"),
        ("tip_rmse_mm = 8.0", "tip_rmse_mm = -8.0", "tuning.before.tip_rmse_mm"),
        ("position_rmse_mm = 3.0", "position_rmse_mm = nan", "tuning.after.position_rmse_mm"),
        ("heading_rmse_deg = 2.0", "heading_rmse_deg = inf", "tuning.validation_before.heading_rmse_deg"),
        ("covariance_inflation = 1.5", "covariance_inflation = 0.5", "tuning.covariance_inflation"),
        ("tip_rmse_mm = 7.0", "tip_rmse_mm = 1e10", "tuning.validation_after.tip_rmse_mm"),
    ] {
        let text = tuned().replacen(from, to, 1);
        let to_line = to.lines().next().unwrap_or(to);
        let line = 1 + text.lines().position(|line| line.contains(to_line)).expect("the edited line");
        let error = error(from, to).to_string();
        assert!(error.starts_with(&format!("line {line}: {key} = ")) && error.contains("expected"), "{to}: {error}");
    }
}

#[test]
fn the_record_of_a_calibration_is_read_and_no_part_of_the_parameters() {
    let text = format!("{TABLE}\n[calibration]\nsessions = [\"sweep.csv\"]\ndate = \"2026-11-30\"\n");
    let file = parse(&text);
    let record = file.calibration.clone().expect("it is in the file");
    assert_eq!((record.sessions, record.date.as_deref()), (vec!["sweep.csv".to_owned()], Some("2026-11-30")));
    let checksum = |file: &ArmFile| file.compile::<Q>(10.0).expect("a table").checksum();
    assert_eq!(checksum(&file), checksum(&parse(TABLE)));
    for (from, to, key) in
        [("[\"sweep.csv\"]", "[]", "calibration.sessions"), ("2026-11-30", "yesterday", "calibration.date")]
    {
        let error = ArmFile::parse(&text.replace(from, to)).expect_err("it must be refused").to_string();
        assert!(error.contains(&format!("{key} = ")), "{error}");
    }
}
