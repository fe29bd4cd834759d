//! `cargo demo`: the main job from end to end. The firmware runs on the emulated board, and what it streams is replayed.

use crate::board;
use crate::tool::{Tool, cargo};

/// Board time of the run, s: the paper's.
const SECONDS: &str = "900";

/// Runs in `target/demo`.
pub fn run() -> Result<(), String> {
    board::add_target()?;
    let tool = Tool::build("demo")?;
    tool.take("calibration-tables/planar-6.toml", "table.toml")?;
    let session = tool.path("session.csv");
    println!("\nThe firmware on the virtual Due, scenario I:");
    cargo(
        &["run", "--quiet", board::ANY_RUST, "--package", "board-tests", "--bin", "demo", "--", &session, SECONDS],
        &[],
    )?;
    tool.run("replay session.csv --table table.toml")
}
