//! Ctrl-C while filters are tuned: the best so far is kept.
#![cfg(unix)]

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use calibration_tables::{ArmFile, DriftToml, StopReason};

use super::common::{Folder, Run, simulate};
use super::tune::{TUNE, spoiled};
use super::tune_bias_filter::with_bias_filter;

/// A tuning that is interrupted after `pause`.
fn interrupted(folder: &Folder, pause: Duration) -> Run {
    let mut command = folder.command(&TUNE);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the tool starts");
    sleep(pause);
    let interrupt = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupt.expect("unix has kill").success());
    child.wait_with_output().expect("the tool ends").into()
}

/// An interrupt that comes before the descent ends the run without a table; the descent takes many times as long, so that
/// one that comes later and later meets it.
fn run_until_heeded(folder: &Folder) -> Run {
    let mut pause = Duration::from_millis(50);
    loop {
        let run = interrupted(folder, pause);
        if run.code != Some(130) {
            return run;
        }
        assert!(!folder.path("tuned.toml").exists(), "an interrupt before the descent leaves no table");
        pause *= 2;
    }
}

#[test]
fn an_interrupted_tuning_writes_the_best_table_so_far_and_reports_it() {
    let folder = Folder::with("session.csv", simulate("--scenario 1 --seconds 600 --seed 54").to_string());
    folder.write("table.toml", spoiled());
    let run = run_until_heeded(&folder);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stderr.starts_with("warning: interrupted after "), "{}", run.stderr);
    assert!(run.stdout.contains("interrupted after "), "{}", run.stdout);

    let table = ArmFile::load(&folder.path("tuned.toml")).expect("a valid table");
    let record = table.tuning.expect("a tuned table has a record");
    assert_eq!(record.stop_reason, StopReason::Interrupted);
    assert_eq!(record.best_iteration, record.iterations);
    assert!(record.after.position_rmse_mm <= record.before.position_rmse_mm, "{record:?}");
    assert!(folder.run(&["replay", "session.csv", "--table", "tuned.toml"]).code == Some(0));
    let entries = std::fs::read_dir(folder.path("")).expect("the folder is there").count();
    assert_eq!(entries, 3, "nothing is left behind");
}

/// The search comes before the descent, and takes longer than both have taken so far.
#[test]
fn an_interrupted_search_for_the_bias_filter_ends_the_tuning_with_a_table() {
    let folder = Folder::with("session.csv", simulate("--scenario 1 --seconds 600 --seed 54").to_string());
    folder.write("table.toml", with_bias_filter(DriftToml::kalman(), None));
    let run = run_until_heeded(&folder);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let record = ArmFile::load(&folder.path("tuned.toml")).expect("a valid table").tuning.expect("a record");
    assert_eq!((record.stop_reason, record.iterations, record.best_iteration), (StopReason::Interrupted, 0, 0));
    assert!(record.drift.is_some_and(|drift| drift.runs > 0), "it was in the search");
}
