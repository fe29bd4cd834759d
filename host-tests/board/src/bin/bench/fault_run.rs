//! A run with all requests and many faults, for worst cases: time of a task, depth of the stack.

use board_tests::{Board, UART};
use rig_twin::Scenario;
use telemetry::{Command, SetPressures, TareMode};
use virtual_due::WiredRig;

/// Requests that the host sends in one burst, more than the line carries in a tick.
const FLOOD: usize = 40;

/// Runs a board through it, by a function that lets a number of milliseconds pass.
///
/// # Panics
/// If the board resets.
pub fn board(mut run_ms: impl FnMut(&mut Board, u64)) -> Board {
    let mut board = Board::new(WiredRig::new(Scenario::FreeSwing, 1));
    // The first tick comes late, as the board is still being set up.
    board.run_ms(50);
    run_ms(&mut board, 1_950);
    for second in 2..20_u32 {
        match second {
            3 => board.inject("imu2:unplugged"),
            5 => board.clear("imu2:unplugged"),
            7 => board.inject("sda:held-clocks=5"),
            9 => board.inject("sda:held-until-reset"),
            11 => board.inject("scl:held"),
            13 => board.clear("scl:held"),
            14 => board.inject("mux:silent"),
            16 => board.inject("bend1a:open"),
            6 | 17 => (0..FLOOD).for_each(|_| {
                board.send(Command::Tare(TareMode::Force));
            }),
            18 => {
                let now = board.machine.now();
                board.machine.world_mut().send(UART, &[0x55; 2_000], now);
            }
            _ => {}
        }
        let pressures_pa = [second * 10_000; 6].into_iter().collect();
        let set = Command::SetPressures(SetPressures { pressures_pa, valid_ms: 500 });
        for command in [Command::Arm, set, Command::Ping, Command::Tare(TareMode::Force)] {
            board.send(command);
            run_ms(&mut board, 250);
        }
    }
    assert_eq!(board.machine.resets(), [], "the firmware survives all of it");
    board
}
