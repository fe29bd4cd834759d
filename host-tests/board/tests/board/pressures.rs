//! Pressures: only when armed, and only as long as a host renews them.

use board_tests::Board;
use estimator_core::Q;
use rig_twin::Scenario;
use telemetry::{Actuation, Command, Event, Refusal, RequestOutcome, SetPressures};
use virtual_due::WiredRig;

/// The right side of all modules at 100 kPa.
const RIGHT_PA: [u32; 6] = [100_000, 0, 100_000, 0, 100_000, 0];

fn right() -> Command {
    Command::SetPressures(SetPressures { pressures_pa: RIGHT_PA.into_iter().collect(), valid_ms: 200 })
}

fn ready() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(2500);
    board
}

#[test]
fn a_board_comes_up_vented() {
    assert!(ready().is_vented());
}

#[test]
fn pressures_move_only_when_armed() {
    let mut board = ready();
    assert_eq!(board.request(right()), RequestOutcome::Nack(Refusal::Disarmed));
    assert!(board.is_vented());
}

#[test]
fn set_pressures_reach_the_regulators() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    assert_eq!(board.request(right()), RequestOutcome::Ack);
    for (commanded, requested) in board.machine.world().set_points_pa().into_iter().zip(RIGHT_PA) {
        // A step of the PWM is 67 Pa.
        assert!((commanded - f64::from(requested)).abs() <= 67.0, "{commanded} Pa of {requested}");
    }
}

#[test]
fn the_arm_moves_and_the_estimate_follows() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    for _ in 0..30 {
        assert_eq!(board.request(right()), RequestOutcome::Ack);
    }
    let truth = board.machine.world().truth();
    let tip = truth[5];
    assert!(tip.x_m > 0.1, "the arm bends to the right: {tip:?}");
    let estimate = board.estimates().next_back().expect("estimates come");
    let end = estimate.segments[5].expect("the tip is known").end.map(|bits| Q::from_bits(bits).to_f64());
    let error_mm = (end[0] - tip.x_m).hypot(end[1] - tip.y_m) * 1000.0;
    assert!(error_mm < 60.0, "estimate {end:?} m, truth {tip:?}, {error_mm} mm apart");
}

#[test]
fn silence_vents_the_arm_within_one_and_a_half_seconds() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    board.send(right());
    board.run_ms(1500);
    assert!(board.is_vented());
    let states: Vec<_> = board.events().filter(|event| matches!(event, Event::Actuation(_))).collect();
    let expected = [Actuation::Armed, Actuation::Holding, Actuation::Ramping, Actuation::Disarmed];
    assert_eq!(states, expected.map(Event::Actuation));
}

#[test]
fn vented_pressures_stay_until_armed_again() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    board.send(right());
    board.run_ms(1600);
    assert_eq!(board.request(right()), RequestOutcome::Nack(Refusal::Disarmed));
    assert!(board.is_vented());
}

#[test]
fn disarm_vents_at_once() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    assert_eq!(board.request(right()), RequestOutcome::Ack);
    board.send(Command::Disarm);
    board.run_ms(30);
    assert!(board.is_vented());
}
