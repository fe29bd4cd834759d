//! The board as a whole: time, faults, resets.

use crate::program::{ENTRY, MILLISECOND, SPIN, WFI, board, elf, firmware, load_r0, with_function};
use rig_twin::Scenario;
use virtual_due::{CYCLES_PER_SECOND, Cause, ImageError, Machine, WiredRig};

#[test]
fn instructions_take_7_5_of_a_core_cycle_and_sleep_takes_none() {
    // movs r0, #1; adds r0, r0, r0; adds r0, r0, r0; wfi; b .
    let mut board = board(&[0x2001, 0x1800, 0x1800, WFI, SPIN], 4);
    assert!(board.run_to(ENTRY + 6, MILLISECOND));
    // Three instructions at 4 MHz.
    assert_eq!((board.instructions(), board.now()), (3, 3 * 7 * 21 / 5));
    board.run_until(CYCLES_PER_SECOND);
    assert_eq!((board.instructions(), board.now()), (4, CYCLES_PER_SECOND));
    assert!(board.sleeps());
}

#[test]
fn the_watchdog_resets_a_program_that_does_not_restart_it() {
    let mut board = board(&[SPIN], 0);
    board.run_until(33 * CYCLES_PER_SECOND);
    let resets: Vec<_> = board.resets().iter().map(|reset| (reset.cause, reset.at / CYCLES_PER_SECOND)).collect();
    assert_eq!(resets, [(Cause::Watchdog, 16), (Cause::Watchdog, 32)]);
}

#[test]
fn a_load_from_nothing_is_a_fault_and_is_reported_with_its_pc() {
    // ldr r0, =0x400A8000; ldr r1, [r0]; b .; movs r7, #1; b .
    let mut board = board(&[load_r0(2), 0x6801, SPIN, 0x2701, SPIN, 0, 0x8000, 0x400A], 3);
    assert!(board.run_to(ENTRY + 8, MILLISECOND), "the fault's handler runs");
    // Two instructions at 4 MHz.
    let lines: Vec<String> = board.reports().iter().map(ToString::to_string).collect();
    assert_eq!(lines, ["0.000001 s, pc 0x00080042: bus fault: load from 0x400a8000, where nothing is mapped"]);
}

#[test]
fn a_report_names_the_function_of_its_instruction() {
    // ldr r0, =0x400A8000; ldr r1, [r0]; b .; movs r7, #1; b .
    let program = firmware(&[load_r0(2), 0x6801, SPIN, 0x2701, SPIN, 0, 0x8000, 0x400A], 3);
    let program = with_function(program, "_ZN9UARTClass5writeEh", ENTRY, 6);
    let mut board = Machine::new(&program, WiredRig::new(Scenario::FreeSwing, 1)).expect("a firmware for the Due");
    board.run_until(MILLISECOND);
    let lines: Vec<String> = board.reports().iter().map(ToString::to_string).collect();
    let expected = "0.000001 s, pc 0x00080042 in UARTClass::write(unsigned char): bus fault: load from 0x400a8000, where \
                    nothing is mapped";
    assert_eq!(lines, [expected]);
}

#[test]
fn a_fault_in_a_faults_handler_locks_up_until_reset() {
    // ldr r0, =0x400A8000; ldr r1, [r0]; b .
    let mut board = board(&[load_r0(2), 0x6801, SPIN, 0, 0, 0, 0x8000, 0x400A], 0);
    board.run_until(CYCLES_PER_SECOND);
    assert!(board.locked_up());
    board.run_until(17 * CYCLES_PER_SECOND - MILLISECOND);
    assert_eq!(board.resets().first().map(|reset| reset.cause), Some(Cause::Watchdog));
}

#[test]
fn ram_survives_the_reset_button() {
    let mut board = board(&[WFI, SPIN], 0);
    board.run_until(MILLISECOND);
    assert!(board.poke(0x2008_7FFC, &[1, 2, 3, 4]));
    board.press_reset();
    board.run_for(MILLISECOND);
    assert_eq!(board.peek(0x2008_7FFC, 4), Some(vec![1, 2, 3, 4]));
    assert_eq!(board.resets().iter().map(|reset| reset.cause).collect::<Vec<_>>(), [Cause::User]);
}

#[test]
fn code_that_a_debugger_changes_runs_as_changed() {
    // movs r7, #1; nop; b -4
    let mut board = board(&[0x2701, 0xBF00, 0xE7FC], 0);
    board.run_until(10 * MILLISECOND);
    board.poke(ENTRY + 2, &WFI.to_le_bytes());
    board.run_for(MILLISECOND);
    assert!(board.sleeps());
}

#[test]
fn code_that_a_program_writes_to_flash_runs_as_written() {
    // Twice: a page of bank 1 = movs r7, #1 (#2); bx lr, by EEFC1; call it. RAM = r7 of the first call, of the second
    let mut board = board(
        &[
            0x4C0D, 0xF44F, 0x2540, 0x4E0D, 0xF44F, 0x60C0, 0x6020, 0x480C, 0xF000, 0xF80A, 0x46B8, 0x480B, 0xF000,
            0xF806, 0x480A, 0xF8A0, 0x8000, 0x8047, WFI, SPIN, 0x6028, 0x6066, 0x68A1, 0x07C9, 0xD0FC, 0xF045, 0x0101,
            0x4708, 0x0C00, 0x400E, 0x0003, 0x5A00, 0x2701, 0x4770, 0x2702, 0x4770, 0x0000, 0x2007,
        ],
        0,
    );
    board.run_until(20 * MILLISECOND);
    assert!(board.sleeps());
    assert_eq!(board.peek(0x2007_0000, 4), Some(vec![1, 0, 2, 0]));
    assert_eq!(board.reports(), []);
}

#[test]
fn a_run_in_pieces_is_the_same_run() {
    // adds r0, r0, #1; ldr r1, [pc, #8]; ldr r1, [r1]; b back; (RTT_VR)
    let program = [0x3001, 0x4902, 0x6809, 0xE7FB, 0, 0, 0x1A38, 0x400E];
    let (mut whole, mut pieces) = (board(&program, 0), board(&program, 0));
    whole.run_until(100 * MILLISECOND);
    for piece in 1..=1000 {
        pieces.run_until(piece * MILLISECOND / 10);
    }
    assert_eq!((whole.instructions(), whole.now(), whole.pc()), (pieces.instructions(), pieces.now(), pieces.pc()));
}

#[test]
fn firmware_for_another_address_is_refused() {
    let refused = Machine::new(&elf(0x0800_0000, &[0; 64]), WiredRig::new(Scenario::FreeSwing, 1)).err();
    assert_eq!(refused, Some(ImageError::Outside { address: 0x0800_0000, length: 64 }));
}
