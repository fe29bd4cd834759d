//! Commands for the board, real or emulated: its target, and the packages that only they build.

use std::process::Command;

use crate::tool::{cargo, check};

/// Lets the emulated board's engine build, which declares a newer Rust than it needs.
pub const ANY_RUST: &str = "--ignore-rust-version";

/// The board's target.
pub const TARGET: &str = "thumbv7m-none-eabi";

/// Adds the board's target to the toolchain where it is missing.
pub fn add_target() -> Result<(), String> {
    let installed = Command::new("rustup").args(["target", "list", "--installed"]).output();
    match installed {
        Ok(output) if String::from_utf8_lossy(&output.stdout).lines().any(|line| line == TARGET) => Ok(()),
        Ok(_) => check(Command::new("rustup").args(["target", "add", TARGET])),
        Err(error) => Err(format!("rustup: {error}; without it, see to it that the target {TARGET} is installed")),
    }
}

/// `cargo verify`: every test, those on the emulated board too.
pub fn verify() -> Result<(), String> {
    add_target()?;
    // The firmware and the on-target tests do not run on a host; `.ci/ros2` tests the node of ROS 2, whose crates nothing else needs.
    let others = ["--exclude", "firmware", "--exclude", "on-target-tests", "--exclude", "proprio-ros2"];
    cargo(&[&["test", "--workspace", ANY_RUST], &others[..]].concat(), &[])
}
