//! `cargo xtask results`: makes `docs/RESULTS.md` anew.

use crate::tool::cargo;

/// Measures everything that the page states.
pub fn run() -> Result<(), String> {
    cargo(&["run", "--release", "--package", "host-tests", "--bin", "results"], &[])
}
