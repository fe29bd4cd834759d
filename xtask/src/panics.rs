//! `cargo xtask panics`: paths to a panic in the firmware, against `host-tests/board/panics.toml`.

use crate::board::{ANY_RUST, add_target};
use crate::tool::cargo;

/// Shows every path; it fails where one is not on the list, or an entry of the list is gone.
pub fn run() -> Result<(), String> {
    add_target()?;
    let test = ["test", "--quiet", ANY_RUST, "--package", "board-tests", "--test", "panics"];
    cargo(&[&test[..], &["--", "--nocapture", "--test-threads", "1"]].concat(), &[])
}
