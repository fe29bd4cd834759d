//! Compiles the arm's table into the firmware, and determines the revision of the source.
//!
//! `PROPRIO_TABLE` names the table's TOML file, from the workspace's folder; without it, it is the reference arm's.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use calibration_tables::ArmFile;
use estimator_core::{Estimator, Q};

/// Samples a second.
const RATE_HZ: f64 = 100.0;

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let path = root.join(env::var_os("PROPRIO_TABLE").unwrap_or_else(|| "calibration-tables/planar-6.toml".into()));
    println!("cargo::rerun-if-env-changed=PROPRIO_TABLE");
    println!("cargo::rerun-if-changed={}", path.display());
    println!("cargo::rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo::rerun-if-changed={}", root.join(".git/HEAD").display());

    match table(&path) {
        Ok(source) => {
            let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it")).join("table.rs");
            fs::write(out, source).expect("cargo's own folder is writable");
        }
        // cargo shows it as the error of this build, without a backtrace.
        Err(error) => println!("cargo::error={error}"),
    }
    println!("cargo::rustc-env=REVISION={}", revision(&root));
}

/// The table's source, with the arm's name and the checksum that `Hello` carries.
fn table(path: &Path) -> Result<String, String> {
    let file = ArmFile::load(path).map_err(|error| format!("PROPRIO_TABLE {}: {error}", path.display()))?;
    let compiled = file.compile::<Q>(RATE_HZ).map_err(|error| format!("PROPRIO_TABLE {}: {error}", path.display()))?;
    // The room that board-core's Arm has.
    Estimator::<Q, 6, 100>::new(&compiled.config())
        .map_err(|error| format!("PROPRIO_TABLE {}: {error}", path.display()))?;
    Ok(format!(
        "{}\n/// Name of the arm.\npub const ARM: &str = {:?};\n\n/// Checksum of the table.\npub const CHECKSUM: u32 = {:#010x};\n",
        compiled.to_rust(),
        file.arm,
        compiled.checksum()
    ))
}

fn revision(root: &Path) -> String {
    let output = Command::new("git").current_dir(root).args(["rev-parse", "--short=12", "HEAD"]).output();
    let text =
        output.ok().filter(|output| output.status.success()).and_then(|output| String::from_utf8(output.stdout).ok());
    text.map_or_else(|| "unknown".to_owned(), |text| text.trim().to_owned())
}
