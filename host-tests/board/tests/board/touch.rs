//! Contact events and uncertainties of the board.

use board_tests::Board;
use rig_twin::{MotionProgram, Push, Scenario};
use telemetry::{Command, Event, Message, RequestOutcome, SegmentUncertainty};
use virtual_due::{CYCLES_PER_SECOND, WiredRig};

use crate::replay::assert_replays;

/// Longest time from a push to its detection, s.
const FOUND_S: f64 = 0.5;
/// Longest time of its event from the sample to the host, s: a tick's work, and bytes before it on the line.
const LINE_S: f64 = 0.05;

/// Runs a board whose arm swings and is pushed by a stick.
fn pushed(seed: u64, seconds: u64) -> Board {
    let program = MotionProgram::new(Scenario::Push, seed);
    let mut board = Board::new(WiredRig::new(Scenario::Push, seed));
    board.run_ms(2000);
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    while board.machine.seconds() < seconds as f64 {
        board.set_pressures(&program.duties(board.machine.seconds()));
        board.run_ms(50);
    }
    board
}

/// Times at which the host had received each event of a contact's begin on a segment, s since power-on.
fn begins_s(board: &Board, segment: usize) -> Vec<f64> {
    let mut was_touched = false;
    let begins = board.received().iter().filter_map(|received| match received.message {
        Message::Event(Event::Contact(_, touched)) => {
            let is_touched = touched >> segment & 1 == 1;
            let begins = is_touched && !was_touched;
            was_touched = is_touched;
            begins.then_some(received.at as f64 / CYCLES_PER_SECOND as f64)
        }
        _ => None,
    });
    begins.collect()
}

#[test]
fn a_push_is_reported_within_half_a_second_and_the_time_of_the_line() {
    let board = pushed(71, 90);
    let pushes = board.machine.world().twin().pushes();
    let strong = |push: &&Push| push.bend_rad.abs() > 10_f64.to_radians() && push.start_s + FOUND_S + LINE_S < 90.0;
    let strong: Vec<_> = pushes.iter().filter(strong).collect();
    assert!(strong.len() >= 5, "{pushes:?}");
    for push in strong {
        let (in_time, reported_s) = (push.start_s..=push.start_s + FOUND_S + LINE_S, begins_s(&board, push.segment));
        assert!(
            reported_s.iter().any(|reported_s| in_time.contains(reported_s)),
            "{push:?} was reported at {reported_s:?}"
        );
    }
    assert_replays(&board, 0);
}

#[test]
fn the_tips_ellipse_is_known_four_times_a_second_and_wider_than_the_bases() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 11));
    board.run_ms(5000);
    let known: Vec<_> = board.uncertainties().filter(|uncertainty| uncertainty.tick >= 300).collect();
    assert!((7..=8).contains(&known.len()), "{}", known.len());
    for uncertainty in known {
        let ends: Vec<_> = uncertainty.segments.iter().filter_map(SegmentUncertainty::end_m2).collect();
        assert_eq!(ends.len(), 6, "{uncertainty:?}");
        let spread = |[xx, _, yy]: [f64; 3]| xx + yy;
        assert!(ends.windows(2).all(|pair| spread(pair[0]) < spread(pair[1])), "{ends:?}");
    }
}
