//! Recordings and tables of version 0.1 stay readable.

use std::path::{Path, PathBuf};

use calibration_tables::ArmFile;
use estimator_core::Q;
use serde_json::Value;

use super::common::{Folder, json, text};

fn here(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-tests").join(name)
}

/// Report of `replay --json` about the recorded estimates, and its output on stderr.
fn replayed(recording: &str, table: &str) -> (Value, String) {
    let (recording, table) = (here("recordings").join(recording), here("tables").join(table));
    let run = Folder::new().done(&["replay", text(&recording), "--table", text(&table), "--json"]);
    (json(&run)["sessions"][0]["recorded"].clone(), run.stderr)
}

fn assert_same_estimates(recording: &str, estimates: u64, contacts: u64) {
    let (recorded, stderr) = replayed(recording, "version-0.1-anchor.toml");
    assert_eq!((&recorded["estimates"], &recorded["equal"]), (&estimates.into(), &estimates.into()), "{stderr}");
    assert_eq!(
        (&recorded["contacts"]["compared"], &recorded["contacts"]["equal"]),
        (&contacts.into(), &contacts.into())
    );
    assert_eq!((&recorded["uncertainties"]["compared"], &recorded["table_matches"]), (&0.into(), &Value::Null));
    assert!(!stderr.contains("warning") && stderr.contains("bit for bit"), "{stderr}");
    assert!(stderr.contains("uncertainties of version 0.1 are not compared"), "{stderr}");
}

#[test]
fn estimates_with_the_anchor_are_reproduced_bit_for_bit() {
    assert_same_estimates("version-0.1-anchor.mcap", 240, 0);
}

#[test]
fn estimates_behind_a_full_window_and_contacts_are_reproduced_bit_for_bit() {
    assert_same_estimates("version-0.1-anchor-raw.mcap", 1180, 3);
}

#[test]
fn estimates_of_the_drift_observer_are_not_compared_and_replay_reports_that_in_one_sentence() {
    let (recorded, stderr) = replayed("version-0.1-observer.mcap", "version-0.1.toml");
    assert_eq!((&recorded["estimates"], &recorded["not_compared"]), (&240.into(), &240.into()));
    assert_eq!((&recorded["first_difference"], &recorded["table_matches"]), (&Value::Null, &Value::Null));
    let sentence = "the 240 recorded estimates were made by the drift observer of version 0.1, which this version replaced: they \
                    are not compared\n";
    assert!(stderr.ends_with(sentence) && !stderr.contains("warning"), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
}

#[test]
fn an_observer_recording_replayed_with_an_anchor_table_differs() {
    let (recorded, stderr) = replayed("version-0.1-observer.mcap", "version-0.1-anchor.toml");
    assert_ne!(recorded["equal"], recorded["estimates"]);
    assert!(stderr.starts_with("warning: ") && stderr.contains("firmware 0.1.0"), "{stderr}");
}

#[test]
fn tables_load_and_compile() {
    let load = |name: &str| ArmFile::load(&here("tables").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let (observer, anchor) = (load("version-0.1.toml"), load("version-0.1-anchor.toml"));
    assert!(observer.bias_filter().is_some() && anchor.bias_filter().is_none());
    assert!(anchor.segments.iter().all(|segment| segment.hysteresis.len() == 3));
    for (file, runs_bias_filter) in [(observer, true), (anchor, false)] {
        let compiled = file.compile::<Q>(100.0).expect("it is a table");
        let config = compiled.config();
        assert_eq!(config.bias_filter.is_some(), runs_bias_filter);
        assert_eq!(config.segments.iter().map(|segment| segment.coupled_to.is_some()).filter(|is| *is).count(), 3);
        assert!(config.contact.is_some() && config.uncertainty.is_some());
    }
}
