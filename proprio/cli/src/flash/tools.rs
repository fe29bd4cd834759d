//! Search for the programs that write a board's flash.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use super::{FlashError, ToolCommand};

/// A way to write the flash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Flasher {
    /// probe-rs, which has found a debug probe.
    Probe,
    /// bossac 1.9 on the PATH, over the programming port.
    Bossac,
    /// The bossac of an Arduino IDE, 1.6 or 1.7, likewise.
    ArduinoBossac(PathBuf),
}

impl Flasher {
    /// The first way that is there.
    ///
    /// # Errors
    /// [`FlashError::NoFlasher`] and errors of `probe-rs list`.
    pub fn find() -> Result<Self, FlashError> {
        if is_probe_found()? {
            return Ok(Self::Probe);
        }
        if is_on_path("bossac") {
            return Ok(Self::Bossac);
        }
        let folder = arduino_folder();
        let found = folder.as_deref().and_then(arduino_bossac);
        found.map(Self::ArduinoBossac).ok_or_else(|| FlashError::NoFlasher(folder.unwrap_or_default()))
    }
}

/// True where probe-rs is installed and finds a probe: it lists each in a line that begins with its number in brackets.
fn is_probe_found() -> Result<bool, FlashError> {
    match ToolCommand::new("probe-rs", &["list"]).output() {
        Ok(list) => Ok(list.lines().any(|line| line.trim_start().starts_with('['))),
        Err(FlashError::Missing(_)) => Ok(false),
        Err(error) => Err(error),
    }
}

/// True where a folder of the PATH has the program.
pub fn is_on_path(program: &str) -> bool {
    let file = format!("{program}{}", env::consts::EXE_SUFFIX);
    let path = env::var_os("PATH");
    env::split_paths(path.as_deref().unwrap_or(OsStr::new(""))).any(|folder| folder.join(&file).is_file())
}

/// Folder in which an Arduino IDE keeps each version of bossac.
fn arduino_folder() -> Option<PathBuf> {
    let (variable, below) = if cfg!(windows) {
        ("LOCALAPPDATA", "Arduino15")
    } else if cfg!(target_os = "macos") {
        ("HOME", "Library/Arduino15")
    } else {
        ("HOME", ".arduino15")
    };
    Some(Path::new(&env::var_os(variable)?).join(below).join("packages").join("arduino").join("tools").join("bossac"))
}

/// The oldest bossac of version 1.6 or 1.7 there: the IDE's package for the Due brings 1.6.1. Later versions, which come with other
/// boards, have other arguments.
fn arduino_bossac(folder: &Path) -> Option<PathBuf> {
    let mut versions: Vec<String> = fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|version| version.starts_with("1.6.") || version.starts_with("1.7."))
        .collect();
    versions.sort();
    let file = format!("bossac{}", env::consts::EXE_SUFFIX);
    versions.into_iter().map(|version| folder.join(version).join(&file)).find(|program| program.is_file())
}
