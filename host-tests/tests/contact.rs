//! Contact as the estimator detects it with the reference table, compared with the simulated arm's contacts.

use std::path::Path;

use calibration_tables::ArmFile;
use host_tests::contact::{ContactSession, Found};
use rig_twin::Scenario;

const SECONDS: f64 = 900.0;
const SEEDS: [u64; 3] = [71, 72, 73];

fn runs(scenario: Scenario) -> [ContactSession; 3] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../calibration-tables/planar-6.toml");
    let table = ArmFile::load(&path).expect("the reference table");
    SEEDS.map(|seed| ContactSession::new(&table, scenario, seed, SECONDS).expect("it is a table"))
}

#[test]
fn a_free_arm_is_never_touched_in_three_quarters_of_an_hour() {
    let alarms = runs(Scenario::FreeSwing).map(|run| run.alarms());
    assert_eq!(alarms, [0; SEEDS.len()]);
}

#[test]
fn nine_in_ten_pushes_over_ten_degrees_are_found_within_half_a_second() {
    let pushes = runs(Scenario::Push).map(|run| run.pushes());
    let [found, all] = [|of: &Found| of.found, |of: &Found| of.all].map(|of| pushes.iter().map(of).sum::<usize>());
    assert!(all > 50 && found * 10 > all * 9, "{found} of {all}");
}
