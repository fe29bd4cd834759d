//! The programs with the files that they find beside themselves.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{copy, emptied};
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
        let packages = ["--package", "proprio", "--bin", "proprio", "--package", "virtual-due", "--bin", "virtual-due"];
        cargo(&[&["build", "--locked", ANY_RUST, "--profile", "bundle"], &packages[..]].concat(), &[])?;
        let program = |name| target().join("bundle").join(format!("{name}{}", env::consts::EXE_SUFFIX));
        let table = root().join("calibration-tables").join("planar-6.toml");
        let companions = [program("virtual-due")].into_iter().chain(firmware.iter().cloned()).chain([table]).collect();
        Ok(Self { proprio: program("proprio"), companions })
    }
}

/// Writes `proprio-VERSION-TARGET.tar.gz` and returns its path.
pub fn archive(files: &Files, folder: &Path) -> Result<PathBuf, String> {
    let name = format!("proprio-{}-{}-{}", env!("CARGO_PKG_VERSION"), env::consts::ARCH, env::consts::OS);
    let content = folder.join(&name);
    emptied(&content)?;
    let licences = ["LICENSE-APACHE", "LICENSE-MIT"].map(|licence| root().join(licence));
    for file in [&files.proprio].into_iter().chain(&files.companions).chain(&licences) {
        copy(file, &content, &file.file_name().unwrap_or_default().to_string_lossy())?;
    }
    let archive = folder.join(format!("{name}.tar.gz"));
    check(Command::new("tar").current_dir(folder).arg("-czf").arg(&archive).arg(&name))?;
    emptied(&content)?;
    Ok(archive)
}
