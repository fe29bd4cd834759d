//! Reports of the board after a fault, a panic or a boot loop; the arm is vented before all else.
//!
//! The firmware is the one that users flash. It is broken as hardware breaks: a debugger writes over its flash or its RAM
//! while it runs.

use board_tests::{Board, firmware};
use object::{Object, ObjectSymbol, Symbol};
use rig_twin::Scenario;
use telemetry::{Command, Hello, Message, Refusal, RequestOutcome, ResetCause, SetPressures, TableStatus};
use virtual_due::{CYCLES_PER_SECOND, Cycles, WiredRig};

fn pressures() -> Command {
    Command::SetPressures(SetPressures { pressures_pa: [100_000; 6].into_iter().collect(), valid_ms: 1000 })
}

/// Time between two looks at a crashing board: shorter than writing the last words takes.
const STEP: Cycles = CYCLES_PER_SECOND / 200_000;

/// Longest time from the crash to the `Hello` after it, ms.
const BACK_WITHIN_MS: u64 = 250;

/// `udf #0`.
const UNDEFINED: [u8; 2] = [0x00, 0xDE];

/// `b .`
const STANDSTILL: [u8; 2] = [0xFE, 0xE7];

/// `push {r0-r7}` in an endless loop.
const RECURSION: [u8; 4] = [0xFF, 0xB4, 0xFD, 0xE7];

/// A board whose arm is under pressure.
fn under_pressure() -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(1500);
    board.pressurise(100_000);
    assert!(!board.is_vented());
    board
}

/// Runs up to the reset that a crash ends in; the arm is vented before.
fn crash(board: &mut Board) {
    let resets = board.machine.resets().len();
    let limit = board.machine.now() + CYCLES_PER_SECOND / 10;
    while !board.is_vented() && board.machine.now() < limit {
        board.machine.run_for(STEP);
    }
    assert!(board.is_vented() && board.machine.resets().len() == resets, "vented first, then reset");
    while board.machine.resets().len() == resets && board.machine.now() < limit {
        board.machine.run_for(STEP);
    }
    assert_eq!(board.machine.resets().len(), resets + 1);
}

/// Breaks the code of the tick, and repairs it once the board has crashed. Returns the address of the broken code.
fn break_the_tick(board: &mut Board, code: &[u8]) -> u32 {
    let tick = board.machine.symbol("TC0").expect("the tick is the timer's interrupt");
    let whole = board.machine.peek(tick, code.len()).expect("it is in flash");
    assert!(board.machine.poke(tick, code));
    crash(board);
    assert!(board.machine.poke(tick, &whole));
    tick
}

/// Makes a task's state that of a future that has returned, which no task does: all its bytes are 1.
fn break_a_task(board: &mut Board) {
    let file = object::File::parse(firmware()).expect("cargo built an ELF");
    let named = |symbol: &Symbol| symbol.name().is_ok_and(|name| name.contains("__rtic_internal_commands_EXEC"));
    let state = file.symbols().find(named).expect("RTIC keeps each task's state");
    assert!(board.machine.poke(state.address() as u32, &vec![1; state.size() as usize]));
}

/// The board's `Hello` after a crash.
fn hello_after(board: &mut Board) -> Hello {
    board.run_ms(BACK_WITHIN_MS);
    let hello = board.hellos().next_back().expect("a board sends `Hello`").clone();
    let samples = board.samples().count();
    board.run_ms(1000);
    assert!(board.samples().count() > samples + 90, "sampling continues");
    assert!(board.is_vented(), "nothing moves without a request");
    hello
}

fn last_words(hello: &Hello) -> &str {
    hello.last_panic.as_deref().expect("they are kept over the reset")
}

#[test]
fn a_fault_vents_the_arm_and_reports_its_address() {
    let mut board = under_pressure();
    let pc = break_the_tick(&mut board, &UNDEFINED);
    let hello = hello_after(&mut board);
    assert_eq!((hello.reset, hello.boot), (ResetCause::Software, 2));
    // UNDEFINSTR (ARMv7-M, B3.2.15).
    assert_eq!(last_words(&hello), format!("HardFault pc={pc:#010x} cfsr=0x00010000"));
}

#[test]
fn a_stack_that_overflows_is_a_fault_and_harms_nothing_else() {
    let mut board = under_pressure();
    break_the_tick(&mut board, &RECURSION);
    let hello = hello_after(&mut board);
    assert_eq!((hello.reset, hello.boot), (ResetCause::Software, 2));
    assert!(last_words(&hello).ends_with("stack overflow?"), "{hello:?}");
}

#[test]
fn a_panic_vents_the_arm_and_reports_its_message() {
    let mut board = under_pressure();
    break_a_task(&mut board);
    crash(&mut board);
    let hello = hello_after(&mut board);
    assert_eq!((hello.reset, hello.boot), (ResetCause::Software, 2));
    let place_and_message = last_words(&hello).split_once(": ").expect("place and message");
    assert!(place_and_message.0.contains(".rs:"), "{hello:?}");
    assert_eq!(place_and_message.1, "`async fn` resumed after completion");
}

#[test]
fn a_task_that_stands_still_is_named_after_the_watchdogs_reset() {
    let mut board = under_pressure();
    let dispatcher = board.machine.symbol("HSMCI").expect("RTIC runs the estimation task from it");
    let whole = board.machine.peek(dispatcher, STANDSTILL.len()).expect("it is in flash");
    assert!(board.machine.poke(dispatcher, &STANDSTILL));
    board.run_ms(BACK_WITHIN_MS);
    assert!(board.is_vented());
    assert!(board.machine.poke(dispatcher, &whole));
    let hello = hello_after(&mut board);
    assert_eq!(hello.reset, ResetCause::Watchdog);
    assert!(last_words(&hello).starts_with("the task Estimator is late"), "{hello:?}");
}

#[test]
fn the_arm_moves_after_a_crash_only_when_armed_again() {
    let mut board = under_pressure();
    break_the_tick(&mut board, &UNDEFINED);
    hello_after(&mut board);
    assert_eq!(board.request(pressures()), RequestOutcome::Nack(Refusal::Disarmed));
    assert_eq!(board.request(Command::Arm), RequestOutcome::Ack);
    assert_eq!(board.request(pressures()), RequestOutcome::Ack);
    assert!(!board.is_vented());
}

#[test]
fn last_words_are_reported_once() {
    let mut board = under_pressure();
    break_the_tick(&mut board, &UNDEFINED);
    board.run_ms(BACK_WITHIN_MS);
    board.machine.press_reset();
    let hello = hello_after(&mut board);
    assert_eq!((hello.reset, hello.boot, hello.last_panic), (ResetCause::Pin, 3, None));
}

#[test]
fn three_crashes_in_a_minute_leave_the_arm_vented_and_the_telemetry_alive() {
    let mut board = under_pressure();
    for crashes in 1..=3 {
        break_the_tick(&mut board, &UNDEFINED);
        assert_eq!(hello_after(&mut board).boot, crashes + 1);
        if crashes < 3 {
            board.pressurise(100_000);
            assert!(!board.is_vented(), "after {crashes} crashes");
        }
    }
    assert_eq!(board.request(Command::Arm), RequestOutcome::Nack(Refusal::SafeMode));
    let counts = |board: &Board| [board.samples().count(), board.estimates().count(), board.healths().count()];
    let before = counts(&board);
    board.run_ms(10_000);
    for (before, after) in before.into_iter().zip(counts(&board)) {
        assert!(after >= before + 39, "{before} messages, {after} after 10 s");
    }
    assert!(board.is_vented());
}

#[test]
fn a_board_that_crashes_before_its_first_tick_starts_without_its_table_the_fourth_time() {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    let file = object::File::parse(firmware()).expect("cargo built an ELF");
    let named = |symbol: &Symbol| symbol.name().is_ok_and(|name| name.contains("TableServer") && name.contains("load"));
    let load = file.symbols().find(named).expect("the table is read by a function of its own");
    // Without the bit of the Thumb state.
    assert!(board.machine.poke(load.address() as u32 & !1, &UNDEFINED));
    board.run_ms(4 * BACK_WITHIN_MS);
    let hello = board.hellos().next_back().expect("a board sends `Hello`").clone();
    assert_eq!((hello.boot, hello.arm.as_str()), (4, ""));
    assert!(hello.last_panic.is_some());
    assert!(board.samples().count() > 20, "it samples");
    let unusable =
        |message: &Message| matches!(message, Message::Table(state) if state.status == TableStatus::Unusable);
    assert!(board.received().iter().any(|received| unusable(&received.message)));
    assert_eq!(board.request(Command::Arm), RequestOutcome::Nack(Refusal::SafeMode));
    assert!(board.is_vented());
}
