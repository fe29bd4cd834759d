//! `cargo xtask bench`: resources of the firmware on the emulated board, against `host-tests/board/budgets.toml`.

use crate::board::{ANY_RUST, add_target};
use crate::tool::cargo;

/// Builds and runs the benchmark; it fails where something is out of its budget.
pub fn run() -> Result<(), String> {
    add_target()?;
    cargo(&["run", "--quiet", ANY_RUST, "--package", "board-tests", "--bin", "bench"], &[])
}
