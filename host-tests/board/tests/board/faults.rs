//! Faults that the board survives, and its reports afterwards.

use board_tests::Board;
use rig_twin::Scenario;
use telemetry::{Event, ResetCause};
use virtual_due::WiredRig;

/// Address of the core's register that disables interrupts 0 to 31 (ARMv7-M, B3.4.5).
const NVIC_ICER0: u32 = 0xE000_E180;

/// Interrupt of TC0's channel 0: the tick.
const TC0: u32 = 27;

fn ready() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(1500);
    board
}

#[test]
fn the_watchdog_bites_a_stuck_task_and_the_arm_is_vented() {
    let mut board = ready();
    board.pressurise(100_000);
    assert!(board.machine.poke_core(NVIC_ICER0, 1 << TC0), "the tick is stuck");
    board.run_ms(250);
    assert!(board.is_vented());
    board.run_ms(100);
    let hello = board.hellos().next_back().expect("a board sends `Hello`");
    assert_eq!((hello.reset, hello.boot), (ResetCause::Watchdog, 2));
}

#[test]
fn a_reset_by_the_port_starts_over() {
    let mut board = ready();
    board.machine.press_reset();
    board.run_ms(100);
    let hello = board.hellos().next_back().expect("a board sends `Hello`");
    assert_eq!((hello.reset, hello.boot), (ResetCause::Pin, 2));
}

#[test]
fn a_stuck_bus_costs_the_imus_and_no_tick() {
    let mut board = ready();
    board.inject("sda:held");
    board.run_ms(1000);
    let sample = board.samples().next_back().expect("samples come");
    assert!(sample.imu.iter().all(Option::is_none) && sample.bend.iter().all(Option::is_some), "{sample:?}");
    let estimate = board.estimates().next_back().expect("estimates come");
    assert!(estimate.segments.iter().all(Option::is_some), "the bend sensors are still used");
    assert_eq!(board.healths().next_back().expect("health comes").overruns, 0);
}

#[test]
fn a_bus_that_a_unit_holds_is_clocked_free() {
    let mut board = ready();
    board.inject("sda:held-clocks=5");
    board.run_ms(1500);
    assert!(board.events().any(|event| event == Event::BusRecovery));
    let sample = board.samples().next_back().expect("samples come");
    assert!(sample.imu.iter().all(Option::is_some), "{sample:?}");
}

#[test]
fn an_imu_that_browns_out_is_back_within_two_seconds() {
    let mut board = ready();
    board.inject("imu4:brown-out");
    board.run_ms(50);
    assert!(board.samples().next_back().expect("samples come").imu[3].is_none());
    board.run_ms(2000);
    assert!(board.samples().next_back().expect("samples come").imu[3].is_some());
}
