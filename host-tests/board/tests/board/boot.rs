//! From power-on to the first frames.

use board_tests::Board;
use rig_twin::Scenario;
use telemetry::{Message, PROTOCOL_VERSION, ResetCause, SCHEMA};
use virtual_due::WiredRig;

#[test]
fn the_board_boots_to_its_first_frames() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(100);
    let first = board.received().first().expect("the board sends within 100 ms");
    assert!(matches!(first.message, Message::Hello(_)), "{first:?}");
    assert!(board.samples().count() >= 5 && board.estimates().count() >= 5);
    assert_eq!(board.machine.resets(), [], "it came up at once");
}

#[test]
fn the_board_identifies_itself() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(100);
    let hello = board.hellos().next().expect("a board sends `Hello`").clone();
    let table = board_tests::table().compile::<estimator_core::Q>(100.0).expect("the reference file is a valid table");
    assert_eq!((hello.protocol, hello.schema), (PROTOCOL_VERSION, SCHEMA));
    assert_eq!((hello.arm.as_str(), hello.table), ("planar-6", table.checksum()));
    assert_eq!((hello.reset, hello.boot, hello.last_panic), (ResetCause::PowerOn, 1, None));
}

#[test]
fn the_same_run_gives_the_same_bytes_however_it_is_cut() {
    let run = |pieces_ms: &[u64]| {
        let mut board = Board::new(WiredRig::new(Scenario::Push, 3));
        for ms in pieces_ms {
            board.run_ms(*ms);
        }
        board.received().to_vec()
    };
    let whole = run(&[2000]);
    assert!(!whole.is_empty());
    assert_eq!(whole, run(&[1, 332, 667, 10, 990]));
}

#[test]
fn nothing_that_the_firmware_touches_is_unmodelled() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(2000);
    assert_eq!(board.machine.reports(), []);
}

#[test]
fn the_board_sleeps_most_of_the_time() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(2000);
    let load = board.healths().next_back().expect("health comes five times a second").load_permille;
    assert!(load > 0 && load < 500, "{load} permille");
}
