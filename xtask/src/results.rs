//! `cargo xtask results`: writes `docs/RESULTS.md` and `docs/FAULTS-OF-SESSIONS.md`.

use crate::tool::cargo;

/// Measures everything that the pages state.
pub fn run() -> Result<(), String> {
    cargo(&["run", "--release", "--package", "host-tests", "--bin", "results"], &[])
}
