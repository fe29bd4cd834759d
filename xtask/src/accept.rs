//! `cargo xtask accept`: accepts the results of the current twin and estimator as expected.
//!
//! Records the committed sessions and the reference table again by their own command lines, then lets the host tests write
//! the estimates that they expect. The diff shows the changes.

use std::fs;

use crate::tool::{Tool, cargo, root};

const COMMANDS: &str = "host-tests/sessions/commands.txt";

/// Runs the command lines in `target/accept` and copies what they made.
pub fn run() -> Result<(), String> {
    let commands = fs::read_to_string(root().join(COMMANDS)).map_err(|error| format!("{COMMANDS}: {error}"))?;
    let tool = Tool::build("accept")?;
    tool.take("calibration-tables/arms/planar-6.toml", "arms/planar-6.toml")?;
    for command in commands.lines() {
        tool.run(&format!("{command} --force"))?;
        match command.split_whitespace().last() {
            // The sweep is large and only a step to the table.
            None | Some("sweep.csv") => {}
            Some("planar-6.toml") => tool.give("planar-6.toml", "calibration-tables/planar-6.toml")?,
            Some(session) => tool.give(session, &format!("host-tests/sessions/{session}"))?,
        }
    }
    cargo(&["test", "--package", "host-tests", "--test", "replay"], &[("PROPRIO_ACCEPT", "1")])
}
