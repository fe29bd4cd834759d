//! `cargo xtask faults`: writes `docs/reference/faults-measured.md` from trials on the emulated board.

use crate::board::{ANY_RUST, add_target};
use crate::tool::cargo;

/// Injects every fault, and measures what the firmware does.
pub fn run() -> Result<(), String> {
    add_target()?;
    cargo(&["run", "--quiet", ANY_RUST, "--package", "board-tests", "--bin", "faults"], &[])
}
