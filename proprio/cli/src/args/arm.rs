//! Arguments about arms that are not calibrated yet.

use std::path::PathBuf;

use clap::Args;

use super::ForceArgs;

#[derive(Debug, Args)]
pub struct NewArmArgs {
    /// Name of the arm [default: that of the file]
    #[arg(long)]
    pub name: Option<String>,
    /// Length of each segment's curved part from the base, mm: 1 to 8 segments, such as 90,90,80
    #[arg(long, value_name = "MM", value_delimiter = ',', num_args = 1, allow_negative_numbers = true)]
    pub lengths_mm: Option<Vec<f64>>,
    /// Bend sensors of each segment, 0 to 2, such as 2,2,1; at most 12 in all
    #[arg(long, value_name = "N", value_delimiter = ',', num_args = 1)]
    pub bend: Option<Vec<u8>>,
    /// Number of pressure regulators, 0 to 8 [default: 0]
    #[arg(long, value_name = "N")]
    pub regulators: Option<u8>,
    /// Pressure of the regulators at full duty, kPa over the atmosphere [default: 280]
    #[arg(long, value_name = "KPA", allow_negative_numbers = true)]
    pub full_scale_kpa: Option<f64>,
    /// Arm description to write
    #[arg(short, long, value_name = "ARM.toml")]
    pub output: PathBuf,
    #[command(flatten)]
    pub force: ForceArgs,
}
