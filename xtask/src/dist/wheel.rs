//! The Python package as a wheel, by maturin.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::files::{copy, emptied};
use super::programs::Files;
use crate::tool::{check, root, target};

/// The version of maturin, from PyPI.
const MATURIN: &str = "maturin==1.16.0";

/// A Python that can make virtual environments.
pub struct Python(&'static str);

impl Python {
    /// The first that is there.
    pub fn find() -> Option<Self> {
        let is_usable = |name: &&str| {
            let mut python = Command::new(name);
            python.args(["-c", "import ensurepip, venv"]).stdout(Stdio::null()).stderr(Stdio::null());
            python.status().is_ok_and(|status| status.success())
        };
        ["python3", "python"].into_iter().find(is_usable).map(Self)
    }
}

/// Builds the wheel with the programs' files in its folder `files`, and returns its path.
pub fn write(python: &Python, files: &Files, folder: &Path) -> Result<PathBuf, String> {
    let package = root().join("python");
    let inside = package.join("proprio").join("files");
    emptied(&inside)?;
    for file in &files.companions {
        copy(file, &inside)?;
    }
    let wheels = target().join("wheels");
    emptied(&wheels)?;
    let maturin = maturin(python)?;
    let arguments = ["build", "--locked", "--profile", "bundle", "--out"];
    let mut build = Command::new(maturin);
    build.current_dir(&package).env("CARGO_TARGET_DIR", target()).args(arguments).arg(&wheels);
    check(&mut build)?;
    let mut built = fs::read_dir(&wheels).map_err(|error| format!("{}: {error}", wheels.display()))?.flatten();
    let wheel = built.next().map(|entry| entry.path()).ok_or("maturin has made no wheel")?;
    copy(&wheel, folder)
}

/// The program maturin, in a virtual environment below `target`.
fn maturin(python: &Python) -> Result<PathBuf, String> {
    let environment = target().join("maturin");
    let programs = environment.join(if cfg!(windows) { "Scripts" } else { "bin" });
    if !programs.exists() {
        check(Command::new(python.0).args(["-m", "venv"]).arg(&environment))?;
    }
    check(Command::new(programs.join("python")).args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        MATURIN,
    ]))?;
    Ok(programs.join("maturin"))
}
