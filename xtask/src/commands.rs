//! `cargo xtask commands`: writes `docs/reference/commands.md` from the program's own arguments.

use crate::tool::cargo;

/// Runs the test that compares the page with the arguments, and has it write the page.
pub fn run() -> Result<(), String> {
    cargo(&["test", "--package", "proprio", "--lib", "commands_page"], &[("PROPRIO_ACCEPT", "1")])
}
