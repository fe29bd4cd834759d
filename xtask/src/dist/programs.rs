//! The programs and the files that they find in their own folder.

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
    pub proprio: PathBuf,
    /// The program `proprio-ros2`, which is not in the Python package.
    pub ros2: PathBuf,
    /// The programs' other files: the emulated board's program, the firmware, the reference arm's table, the licences.
    pub companions: Vec<PathBuf>,
}

impl Files {
    /// Builds the programs; `firmware` is written already.
    pub fn build(firmware: &[PathBuf]) -> Result<Self, String> {
        // With the features that the Python package needs of all crates, so that its build finds them.
        let both = ["--package", "proprio", "--package", "proprio-python", "--bin", "proprio"];
        cargo(&[&["build", "--locked", "--profile", "bundle"], &both[..]].concat(), &[])?;
        let program = |folder, name| target().join(folder).join(format!("{name}{}", env::consts::EXE_SUFFIX));
        emptied(&target().join("stripped"))?;
        let board = emulated_board(&program("debug", "virtual-due"))?;
        let ros2 = ros2(&program("debug", "proprio-ros2"))?;
        let others =
            ["calibration-tables/planar-6.toml", "LICENSE-APACHE", "LICENSE-MIT"].map(|file| root().join(file));
        let companions = [board].into_iter().chain(firmware.iter().cloned()).chain(others).collect();
        Ok(Self { proprio: program("bundle", "proprio"), ros2, companions })
    }
}

/// Builds the emulated board's program in the dev profile, in which the tests run it: its heavy crates are optimised there. It
/// has the features of `cargo demo`, which finds the same build. Returns the path of a stripped copy.
fn emulated_board(built: &Path) -> Result<PathBuf, String> {
    let packages = ["--package", "proprio", "--package", "board-tests", "--package", "virtual-due"];
    cargo(&[&["build", "--locked", ANY_RUST], &packages[..], &["--bin", "virtual-due"]].concat(), &[])?;
    stripped(built)
}

/// Builds the node of ROS 2 in the dev profile, in which `.ci/ros2` tests it: its crates have features that those of `proprio` do
/// not have, and would all be built once more. Returns the path of a stripped copy.
fn ros2(built: &Path) -> Result<PathBuf, String> {
    cargo(&["build", "--locked", "--package", "proprio-ros2"], &[])?;
    stripped(built)
}

/// Copies a program without its symbols, and returns the path of the copy.
fn stripped(built: &Path) -> Result<PathBuf, String> {
    let program = copy(built, &target().join("stripped"))?;
    // Every Linux and macOS with a linker has it; on Windows the program has its debug information in another file.
    if !cfg!(windows) {
        check(Command::new("strip").arg(&program))?;
    }
    Ok(program)
}

/// Writes `proprio-VERSION-TARGET.tar.gz` and returns its path.
pub fn archive(files: &Files, folder: &Path) -> Result<PathBuf, String> {
    let name = format!("proprio-{}-{}-{}", env!("CARGO_PKG_VERSION"), env::consts::ARCH, env::consts::OS);
    let content = folder.join(&name);
    emptied(&content)?;
    for file in [&files.proprio, &files.ros2].into_iter().chain(&files.companions) {
        copy(file, &content)?;
    }
    let archive = folder.join(format!("{name}.tar.gz"));
    check(Command::new("tar").current_dir(folder).arg("-czf").arg(&archive).arg(&name))?;
    fs::remove_dir_all(&content).map_err(|error| format!("{}: {error}", content.display()))?;
    Ok(archive)
}
