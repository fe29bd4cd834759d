//! Resources of the whole firmware: time, memory, stack.

use std::time::Instant;

use board_tests::{Board, firmware};
use object::{Object, ObjectSection};
use rig_twin::Scenario;
use virtual_due::{CYCLES_PER_SECOND, WiredRig};

use crate::fault_run;
use crate::figure::Figure;

/// Sections in flash, from which a reset starts.
const FLASH: [&str; 4] = [".vector_table", ".text", ".rodata", ".data"];
/// Sections in RAM, without the stack.
const STATIC_RAM: [&str; 3] = [".data", ".bss", ".uninit"];
/// Cycles of an instruction on the emulated board, the mean of Cortex-M3 code from the Due's flash.
const CYCLES_PER_INSTRUCTION: f64 = 1.4;
/// Byte with which cortex-m-rt's `paint-stack` fills the stack before anything runs.
const PAINT: u8 = 0xCC;

/// Figures of the firmware, alone and in the rig.
///
/// # Panics
/// If it does not run.
pub fn figures() -> Vec<Figure> {
    let mut figures = vec![
        Figure { name: "flash", value: size(&FLASH) },
        Figure { name: "static_ram", value: size(&STATIC_RAM) },
        Figure { name: "stack", value: deepest_stack() },
    ];
    figures.extend(without_faults());
    figures
}

/// Bytes of the firmware's sections of these names.
fn size(names: &[&str]) -> f64 {
    let file = object::File::parse(firmware()).expect("cargo built an ELF");
    let sections = names.iter().filter_map(|name| file.section_by_name(name));
    sections.map(|section| section.size()).sum::<u64>() as f64
}

/// Figures of a rig without faults, with all messages at 100 Hz.
fn without_faults() -> [Figure; 3] {
    const SECONDS: u32 = 60;
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    board.run_ms(2_000);
    let (instructions, started) = (board.machine.instructions(), Instant::now());
    board.run_ms(u64::from(SECONDS) * 1000);
    let wall = started.elapsed().as_secs_f64();
    let cycles = (board.machine.instructions() - instructions) as f64 * CYCLES_PER_INSTRUCTION;
    let available = f64::from(SECONDS) * CYCLES_PER_SECOND as f64;
    let imu_round = board.healths().map(|health| health.longest_imu_read_us).max().expect("health is sent");
    [
        Figure { name: "load", value: cycles / available * 100.0 },
        Figure { name: "imu_round", value: imu_round.into() },
        Figure { name: "emulator_speed", value: f64::from(SECONDS) / wall },
    ]
}

/// The deepest stack, bytes, in a run with all requests and many faults. A reset would paint it again.
fn deepest_stack() -> f64 {
    let board = fault_run::board(Board::run_ms);
    let [end, start] =
        ["_stack_end", "_stack_start"].map(|name| board.machine.symbol(name).expect("the linker defines it"));
    let stack = board.machine.peek(end, (start - end) as usize).expect("it is in RAM");
    let untouched = stack.iter().take_while(|byte| **byte == PAINT).count();
    assert!(untouched > 0, "the stack is painted, and has not overflowed");
    (stack.len() - untouched) as f64
}
