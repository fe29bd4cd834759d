//! The board's stream is enough to compute the same estimates, bit for bit, on a host.

use board_tests::{Board, replay, table};
use calibration_tables::ArmFile;
use rig_twin::{MotionProgram, Scenario};
use telemetry::{Command, Event, RequestOutcome, TareMode};
use virtual_due::WiredRig;

/// Checks that every estimate, uncertainty and contact of the board equals the host's of the same samples. The first
/// `skipped` samples are of an earlier boot, which had no table.
pub fn assert_replays(board: &Board, skipped: usize) {
    assert_replays_of(&table(), board, skipped);
    // The last sample may have left the board before its estimate.
    assert!(board.samples().count() - skipped - board.estimates().count() <= 1);
}

/// As [`assert_replays`], of another arm, whose estimates may have a lower rate than its samples.
pub fn assert_replays_of(table: &ArmFile, board: &Board, skipped: usize) {
    let expected = replay(table, board.samples().skip(skipped));
    let found: Vec<_> = board.estimates().collect();
    assert!(found.len() > 100, "{} estimates", found.len());
    for found in &found {
        let expected = expected.iter().find(|expected| expected.estimate.tick == found.tick);
        assert_eq!(Some(*found), expected.map(|expected| &expected.estimate));
    }
    let uncertainties: Vec<_> = board.uncertainties().collect();
    assert!(uncertainties.len() >= found.len() / 25, "{} uncertainties", uncertainties.len());
    for found in uncertainties {
        let expected = expected.iter().find(|expected| expected.uncertainty.tick == found.tick);
        assert_eq!(Some(found), expected.map(|expected| &expected.uncertainty));
    }
    let received: Vec<_> = board.events().filter(|event| matches!(event, Event::Contact(..))).collect();
    let expected: Vec<_> = expected.iter().filter_map(|expected| expected.contact).collect();
    assert!(
        received.len() == expected.len() || received.len() + 1 == expected.len(),
        "{received:?}, expected {expected:?}"
    );
    assert_eq!(received, expected[..received.len()]);
}

#[test]
fn every_estimate_is_the_hosts_of_the_same_sample() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 5));
    board.run_ms(2000);
    board.swing(&MotionProgram::new(Scenario::FreeSwing, 5), 20);
    assert_replays(&board, 0);
}

#[test]
fn every_estimate_is_the_hosts_after_a_tare() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 6));
    board.run_ms(2000);
    board.swing(&MotionProgram::new(Scenario::FreeSwing, 6), 3);
    board.run_ms(2500);
    assert_eq!(board.request(Command::Tare(TareMode::Force)), RequestOutcome::Ack);
    board.swing(&MotionProgram::new(Scenario::FreeSwing, 6), 3);
    assert_eq!(board.samples().next_back().expect("samples come").tare_epoch, 2);
    assert_replays(&board, 0);
}

#[test]
fn the_stream_decodes_without_a_loss() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 7));
    board.run_ms(10_000);
    let counts = board.counts();
    assert_eq!((counts.lost, counts.damaged, counts.wrong_version, counts.unknown), (0, 0, 0, 0));
    let ticks: Vec<_> = board.samples().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1), "a tick is missing");
    assert!(ticks.len() >= 990);
    let health = board.healths().next_back().expect("health comes");
    assert_eq!((health.dropped_frames, health.overruns, health.stale_scans), (0, 0, 0));
}

#[test]
fn the_stream_leaves_a_fifth_of_the_line_to_spare() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 8));
    board.run_ms(2000);
    let before = board.bytes();
    board.run_ms(10_000);
    let rate = (board.bytes() - before) / 10;
    assert!(rate <= 20_000, "{rate} bytes/s");
}

#[test]
fn ticks_are_ten_milliseconds_apart_to_the_microsecond() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 9));
    board.run_ms(3000);
    let times: Vec<_> = board.samples().map(|sample| sample.time_us).collect();
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] == 10_000));
}

#[test]
fn an_estimate_is_made_within_six_milliseconds_of_its_tick() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 10));
    board.run_ms(3000);
    let longest = board.healths().map(|health| health.max_estimate_latency_us).max().expect("health comes");
    assert!((1000..6000).contains(&longest), "{longest} µs");
}
