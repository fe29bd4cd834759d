//! `cargo demo`: the main job from end to end, in the commands that a user types.

use crate::tool::Tool;

/// Duration of each simulated session, s: the paper's.
const SECONDS: &str = "900";

/// Simulates, calibrates and replays in `target/demo`.
pub fn run() -> Result<(), String> {
    let tool = Tool::build("demo")?;
    tool.take("calibration-tables/arms/planar-6.toml", "arm.toml")?;
    tool.run(&format!("simulate --scenario sweep --seconds {SECONDS} --seed 1 -o sweep.csv"))?;
    tool.run("calibrate sweep.csv --arm arm.toml -o table.toml")?;
    for scenario in 1..=3 {
        let seed = 10 + scenario;
        tool.run(&format!(
            "simulate --scenario {scenario} --seconds {SECONDS} --seed {seed} -o scenario-{scenario}.csv"
        ))?;
    }
    tool.run("replay scenario-1.csv scenario-2.csv scenario-3.csv --table table.toml")
}
