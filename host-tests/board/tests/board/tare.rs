//! A request to tare: taken at rest, refused while the arm moves, and answered with the pose.

use board_tests::Board;
use estimator_core::Q;
use rig_twin::{MotionProgram, Scenario};
use telemetry::{Command, Event, Message, Refusal, RequestOutcome, TareMode, TareReport};
use virtual_due::WiredRig;

/// The last report on a pose, in degrees.
fn last_report(board: &Board) -> ([u8; 2], [f64; 2]) {
    let report = board.received().iter().rev().find_map(|received| match received.message {
        Message::Tare(report) => Some(report),
        _ => None,
    });
    let TareReport { turned, bent, .. } = report.expect("each request to tare is answered with the pose");
    let ((turned_segment, turned), (bent_segment, bent)) = (turned.expect("all IMUs"), bent.expect("all sensors"));
    ([turned_segment, bent_segment], [turned, bent].map(|angle| Q::from_bits(angle).to_f64().to_degrees()))
}

fn tares(board: &Board) -> usize {
    board.events().filter(|event| matches!(event, Event::Tare(_))).count()
}

fn ready() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 5));
    board.run_ms(3000);
    board
}

#[test]
fn an_arm_at_rest_is_tared_and_the_board_says_how_still_and_how_straight_it_was() {
    let mut board = ready();
    let before = tares(&board);
    assert_eq!(board.request(Command::Tare(TareMode::IfStill)), RequestOutcome::Ack);
    assert_eq!(tares(&board), before + 1);
    let (_, [turned, bent]) = last_report(&board);
    assert!((0.0..1.0).contains(&turned), "it turned by {turned}°");
    assert!(bent.abs() < 10.0, "it is bent by {bent}°");
}

#[test]
fn a_moving_arm_is_refused_and_tared_only_by_force() {
    let mut board = ready();
    let program = MotionProgram::new(Scenario::FreeSwing, 5);
    board.swing(&program, 10);
    let before = tares(&board);
    assert_eq!(board.request(Command::Tare(TareMode::IfStill)), RequestOutcome::Nack(Refusal::Moving));
    let (_, [turned, _]) = last_report(&board);
    assert!(turned > 1.0, "it turned by {turned}°");
    assert_eq!(tares(&board), before);
    assert_eq!(board.request(Command::Tare(TareMode::Force)), RequestOutcome::Ack);
    assert_eq!(tares(&board), before + 1);
}
