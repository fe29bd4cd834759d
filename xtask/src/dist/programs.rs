//! The programs with the files that they find beside themselves.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::files::{copy, emptied};
use crate::board::ANY_RUST;
use crate::tool::{cargo, check, root, target};

/// Files that belong together.
pub struct Files {
    /// The program `proprio`.
    proprio: PathBuf,
    /// The programs' other files: the emulated board's program, the firmware, the reference arm's table.
    pub companions: Vec<PathBuf>,
}

impl Files {
    /// Builds the programs; `firmware` is written already.
    pub fn build(firmware: &[PathBuf]) -> Result<Self, String> {
        cargo(&["build", "--locked", "--profile", "bundle", "--package", "proprio", "--bin", "proprio"], &[])?;
        // In the dev profile, in which the tests run it: its heavy crates are optimised, and built already.
        let board = ["rustc", "--locked", ANY_RUST, "--package", "virtual-due", "--bin", "virtual-due"];
        cargo(&[&board[..], &["--", "-C", "strip=symbols"]].concat(), &[])?;
        let program = |folder, name| target().join(folder).join(format!("{name}{}", env::consts::EXE_SUFFIX));
        let table = root().join("calibration-tables").join("planar-6.toml");
        let companions =
            [program("debug", "virtual-due")].into_iter().chain(firmware.iter().cloned()).chain([table]).collect();
        Ok(Self { proprio: program("bundle", "proprio"), companions })
    }
}

/// Writes `proprio-VERSION-TARGET.tar.gz` and returns its path.
pub fn archive(files: &Files, folder: &Path) -> Result<PathBuf, String> {
    let name = format!("proprio-{}-{}-{}", env!("CARGO_PKG_VERSION"), env::consts::ARCH, env::consts::OS);
    let content = folder.join(&name);
    emptied(&content)?;
    let licences = ["LICENSE-APACHE", "LICENSE-MIT"].map(|licence| root().join(licence));
    for file in [&files.proprio].into_iter().chain(&files.companions).chain(&licences) {
        copy(file, &content)?;
    }
    let archive = folder.join(format!("{name}.tar.gz"));
    check(Command::new("tar").current_dir(folder).arg("-czf").arg(&archive).arg(&name))?;
    fs::remove_dir_all(&content).map_err(|error| format!("{}: {error}", content.display()))?;
    Ok(archive)
}
