//! The checks find what breaks an invariant, in a stream of a real board that is changed here.

use estimator_core::Q;
use rig_twin::Scenario;
use telemetry::{Message, TICK_HZ};
use virtual_due::WiredRig;

use super::checks::{Checks, Excuse};
use super::finding::Invariant;
use super::truth::TruthLog;
use crate::board::Board;
use crate::replay::table;

/// The stream of a board that starts.
fn stream() -> Vec<Message> {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(2500);
    board.take().0.into_iter().map(|received| received.message).collect()
}

/// The invariants that a stream breaks.
fn broken(stream: &[Message], excuse: Excuse) -> Vec<Invariant> {
    let compiled = table().compile::<Q>(TICK_HZ).expect("the reference table is valid");
    let config = compiled.config();
    let mut checks = Checks::new(&config);
    let truth = TruthLog::default();
    for message in stream {
        checks.message(message, 0.0, &truth, excuse);
    }
    let mut broken: Vec<_> = checks.take_findings().into_iter().map(|finding| finding.invariant).collect();
    broken.sort_unstable();
    broken.dedup();
    broken
}

fn has_tick(message: &Message, tick: u32) -> bool {
    matches!(message, Message::Sample(sample) if sample.tick == tick)
}

#[test]
fn a_whole_stream_breaks_nothing() {
    assert_eq!(broken(&stream(), Excuse::default()), []);
}

#[test]
fn a_sample_that_is_missing_is_found_unless_the_line_loses_messages() {
    let mut stream = stream();
    stream.retain(|message| !has_tick(message, 200));
    assert_eq!(broken(&stream, Excuse::default()), [Invariant::EveryTick]);
    assert_eq!(broken(&stream, Excuse { lost: true, ..Excuse::default() }), []);
}

#[test]
fn an_estimate_that_differs_by_one_bit_is_found() {
    let mut stream = stream();
    let last = stream.iter_mut().rev().find_map(|message| match message {
        Message::Estimate(estimate) => Some(estimate),
        _ => None,
    });
    last.expect("estimates come").segments[5].as_mut().expect("the tip is known").end[0] ^= 1;
    assert_eq!(broken(&stream, Excuse::default()), [Invariant::Replay]);
}

#[test]
fn a_segment_that_is_unknown_after_the_tare_is_found() {
    let mut stream = stream();
    for message in &mut stream {
        match message {
            Message::Estimate(estimate) if estimate.tick == 240 => estimate.segments[2] = None,
            _ => {}
        }
    }
    assert_eq!(broken(&stream, Excuse::default()), [Invariant::Known, Invariant::Replay]);
}

#[test]
fn a_counter_that_decreases_and_an_overrun_are_found() {
    let mut stream = stream();
    let first = stream.iter_mut().find_map(|message| match message {
        Message::Health(health) => Some(health),
        _ => None,
    });
    first.expect("health comes").damaged_frames = 7;
    let last = stream.iter_mut().rev().find_map(|message| match message {
        Message::Health(health) => Some(health),
        _ => None,
    });
    last.expect("health comes").overruns = 1;
    assert_eq!(broken(&stream, Excuse::default()), [Invariant::Counters, Invariant::Overruns]);
}
