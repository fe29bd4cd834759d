//! Compiles the arm's table to Rust source.

use std::path::PathBuf;
use std::{env, fs};

use calibration_tables::ArmFile;
use estimator_core::Q;

/// Sample rate of the program, Hz.
const RATE_HZ: f64 = 100.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let table = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?).join("../../../calibration-tables/planar-6.toml");
    println!("cargo::rerun-if-changed={}", table.display());
    let source = ArmFile::load(&table)?.compile::<Q>(RATE_HZ)?.to_rust();
    fs::write(PathBuf::from(env::var("OUT_DIR")?).join("table.rs"), source)?;
    Ok(())
}
