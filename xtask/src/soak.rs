//! `cargo xtask soak`: hours of the firmware under random faults, on the emulated board.

use crate::board::{ANY_RUST, add_target};
use crate::tool::cargo;

const USAGE: &str = "usage: cargo xtask soak [--seconds S] [--seed K]";

/// Injects faults drawn by the seed over the board's time, and checks what holds at all times.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let (mut seconds, mut seed) = (3600, 1);
    let (pairs, rest) = arguments.as_chunks();
    for [flag, value] in pairs {
        let number: u32 = value.parse().map_err(|_| format!("{flag} {value}: give a whole number; {USAGE}"))?;
        match flag.as_str() {
            "--seconds" => seconds = number,
            "--seed" => seed = number,
            _ => return Err(USAGE.to_owned()),
        }
    }
    if !rest.is_empty() {
        return Err(USAGE.to_owned());
    }
    add_target()?;
    let (seconds, seed) = (seconds.to_string(), seed.to_string());
    cargo(&["run", "--quiet", ANY_RUST, "--package", "board-tests", "--bin", "soak", "--", &seconds, &seed], &[])
}
