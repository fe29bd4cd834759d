//! Requests over the serial line.

use board_tests::{Board, UART};
use rig_twin::Scenario;
use telemetry::{Command, Message, Rates, Refusal, Request, RequestOutcome, ResetCause, SetPressures, TareMode};
use virtual_due::WiredRig;

fn ready() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(1500);
    board
}

#[test]
fn a_ping_is_answered_with_a_hello() {
    let mut board = ready();
    let before = board.hellos().count();
    board.send(Command::Ping);
    board.run_ms(40);
    assert!(board.hellos().count() > before);
}

#[test]
fn rates_slow_the_stream_down() {
    let mut board = ready();
    assert_eq!(
        board.request(Command::Rates(Rates { sample: 0, estimate: 10, health: 0, uncertainty: 0 })),
        RequestOutcome::Ack
    );
    let before = (board.samples().count(), board.estimates().count(), board.healths().count());
    board.run_ms(1000);
    let after = (board.samples().count(), board.estimates().count(), board.healths().count());
    assert_eq!((after.0 - before.0, after.1 - before.1, after.2 - before.2), (0, 10, 0));
}

#[test]
fn a_repeated_request_acts_once_and_is_answered_again() {
    let mut board = ready();
    let tares = board.samples().next_back().expect("samples come").tare_epoch;
    let request = Request { id: 77, command: Command::Tare(TareMode::Force) };
    for _ in 0..3 {
        board.send_again(&request);
        board.run_ms(50);
    }
    assert_eq!(board.samples().next_back().expect("samples come").tare_epoch, tares + 1);
    let replies = board.received().iter().filter(|received| matches!(received.message, Message::Reply(_)));
    assert_eq!(replies.count(), 3);
}

#[test]
fn a_pressure_over_the_range_is_refused() {
    let mut board = ready();
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    let over = SetPressures { pressures_pa: [0, 0, 0, 280_001, 0, 0].into_iter().collect(), valid_ms: 100 };
    assert_eq!(board.request(Command::SetPressures(over)), RequestOutcome::Nack(Refusal::OverRange));
}

#[test]
fn a_reboot_is_answered_and_then_done() {
    let mut board = ready();
    assert_eq!(board.request(Command::Reboot), RequestOutcome::Ack);
    board.run_ms(200);
    let hello = board.hellos().next_back().expect("a board sends `Hello`");
    assert_eq!((hello.reset, hello.boot), (ResetCause::Software, 2));
}

#[test]
fn a_flood_of_noise_changes_nothing_but_a_count() {
    let mut board = ready();
    // Half a second of the line, zeros among them.
    let noise: Vec<u8> = (0_u32..12_500).map(|n| (n.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let now = board.machine.now();
    board.machine.world_mut().send(UART, &noise, now);
    board.run_ms(1000);
    let health = board.healths().next_back().expect("health comes");
    assert!(health.damaged_frames > 10, "{health:?}");
    assert_eq!((health.overruns, health.dropped_frames), (0, 0));
    assert_eq!(board.request(Command::Ping), RequestOutcome::Ack);
}

#[test]
fn a_flood_of_requests_delays_no_tick() {
    let mut board = ready();
    for _ in 0..200 {
        board.send(Command::Ping);
    }
    board.run_ms(1000);
    let ticks: Vec<_> = board.samples().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] == pair[0] + 1), "a tick is missing");
    assert_eq!(board.healths().next_back().expect("health comes").overruns, 0);
}
