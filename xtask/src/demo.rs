//! `cargo demo`: the main job from end to end. The firmware runs on the emulated board, and its stream is replayed.

use crate::board;
use crate::tool::{Tool, cargo};

/// Board time of the run, s, where `--seconds` gives no other.
const DEFAULT_SECONDS: u32 = 150;

/// Runs in `target/demo`.
pub fn run(arguments: &[String]) -> Result<(), String> {
    let seconds = seconds(arguments)?;
    board::add_target()?;
    // One build for both programs, so that each crate is compiled once.
    cargo(
        &[
            "build",
            board::ANY_RUST,
            "--package",
            "proprio",
            "--package",
            "board-tests",
            "--bin",
            "proprio",
            "--bin",
            "demo",
        ],
        &[],
    )?;
    let tool = Tool::built("demo")?;
    tool.take("calibration-tables/planar-6.toml", "table.toml")?;
    println!("\nThe firmware on the virtual Due, scenario I:");
    tool.run_other("demo", &[&tool.path("session.csv"), &seconds.to_string()])?;
    tool.run("replay session.csv --table table.toml")
}

fn seconds(arguments: &[String]) -> Result<u32, String> {
    match arguments {
        [] => Ok(DEFAULT_SECONDS),
        [flag, value] if flag == "--seconds" => match value.parse() {
            Ok(seconds @ 10..=86_400) => Ok(seconds),
            _ => Err(format!("--seconds {value}: give the board's time in whole seconds, 10 to 86400")),
        },
        _ => Err("usage: cargo demo [--seconds N]".to_owned()),
    }
}
