//! A minute of the soak; `cargo xtask soak` runs hours.

use board_tests::soak::soak;

/// A seed whose minute has a restart and two faults at once.
const SEED: u64 = 9;

#[test]
fn a_minute_of_random_faults_breaks_no_invariant() {
    let report = soak(SEED, 60, |_| ());
    assert!(report.seconds >= 60.0 && report.replays > 3000 && report.restarts > 0, "{report}");
    assert_eq!(report.unexplained().count(), 0, "{report}");
}
