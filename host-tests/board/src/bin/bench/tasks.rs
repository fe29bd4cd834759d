//! Longest run of each task of the firmware.

use board_tests::firmware;
use object::{Object, ObjectSection, ObjectSymbol};
use virtual_due::{CYCLES_PER_SECOND, Cycles};

use crate::fault_run;
use crate::figure::Figure;

const CYCLES_PER_US: f64 = CYCLES_PER_SECOND as f64 / 1e6;
const CYCLES_PER_MS: Cycles = CYCLES_PER_SECOND / 1000;

/// Time after a tick at which its work is over and the next has not started.
const TICK: Cycles = CYCLES_PER_SECOND / 100 - CYCLES_PER_MS / 10;

/// The interrupt's handler that runs a task: its first instruction and its last.
struct Handler {
    entry: u32,
    exit: u32,
}

/// The longest of each task, µs, in a run with requests and faults: from the first instruction of its interrupt to the last,
/// what preempts it included; of `estimation`, which waits in between, from the tick to the end of its last piece.
pub fn figures() -> [Figure; 5] {
    let longest = |name, handler| Figure { name, value: longest(&Handler::of(handler)) as f64 / CYCLES_PER_US };
    [
        longest("task_twi1", "TWI1"),
        longest("task_time", "TC1"),
        longest("task_tick", "TC0"),
        longest("task_commands", "SPI0"),
        Figure { name: "task_estimation", value: longest_tick() as f64 / CYCLES_PER_US },
    ]
}

impl Handler {
    /// The handler of this name.
    ///
    /// # Panics
    /// If it returns in more than one place.
    fn of(name: &str) -> Self {
        let file = object::File::parse(firmware()).expect("cargo built an ELF");
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name)).expect("the vector table names it");
        let entry = symbol.address() as u32 & !1;
        let text = file.section_by_name(".text").expect("a firmware has code");
        let code = text.data_range(entry.into(), symbol.size()).ok().flatten();
        let code = code.expect("the handler is code");
        // Handlers begin with `push {…, lr}` and end with `pop {…, pc}` of the same registers (ARMv7-M, A7.7.99 and A7.7.98).
        let [registers, push, ..] = code[..] else { panic!("{name} is empty") };
        assert_eq!(push, 0xB5, "{name} begins with a push");
        let exits = (0..).step_by(2).zip(code.chunks_exact(2)).filter(|(_, halfword)| **halfword == [registers, 0xBD]);
        let exits: Vec<u32> = exits.map(|(offset, _)| entry + offset).collect();
        let [exit] = exits[..] else { panic!("{name} returns in one place, not at {exits:x?}") };
        Self { entry, exit }
    }
}

/// The longest run of a handler, cycles.
fn longest(handler: &Handler) -> Cycles {
    let mut longest = 0;
    fault_run::board(|board, ms| {
        let end = board.machine.now() + ms * CYCLES_PER_MS;
        while board.machine.run_to(handler.entry, end) {
            let start = board.machine.now();
            assert!(board.machine.run_to(handler.exit, end + TICK), "a task ends");
            longest = longest.max(board.machine.now() - start);
        }
        board.run_ms(0);
    });
    longest
}

/// The longest from a tick to the last piece of the estimation task, cycles.
fn longest_tick() -> Cycles {
    let (tick, estimation) = (Handler::of("TC0"), Handler::of("HSMCI"));
    let mut longest = 0;
    fault_run::board(|board, ms| {
        let end = board.machine.now() + ms * CYCLES_PER_MS;
        while board.machine.run_to(tick.entry, end) {
            let start = board.machine.now();
            while board.machine.run_to(estimation.exit, start + TICK) {
                longest = longest.max(board.machine.now() - start);
            }
        }
        board.run_ms(0);
    });
    longest
}
