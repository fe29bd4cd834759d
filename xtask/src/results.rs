//! `cargo xtask results`: writes `docs/explanation/results.md` and `docs/explanation/faults-of-sessions.md`.

use crate::tool::cargo;

/// Measures everything that the pages state.
pub fn run() -> Result<(), String> {
    cargo(&["run", "--release", "--package", "host-tests", "--bin", "results"], &[])
}
