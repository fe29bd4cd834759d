//! From power-on to the first frames.

use board_tests::Board;
use rig_twin::Scenario;
use virtual_due::Rig;

#[test]
fn the_board_boots_to_its_first_frames() {
    let mut board = Board::new(Rig::new(Scenario::One, 1));
    board.run_ms(100);
    let first = board.received().first().expect("the board speaks within 100 ms");
    assert!(matches!(first.message, telemetry::Message::Hello(_)), "{first:?}");
    assert!(board.samples().count() >= 5 && board.estimates().count() >= 5);
    assert_eq!(board.machine.resets(), [], "it came up at once");
}
