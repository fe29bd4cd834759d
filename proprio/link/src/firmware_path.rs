//! The prebuilt firmware of a program.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Name of the firmware in a folder of programs.
const PREBUILT: &str = "firmware.elf";

/// Path of the prebuilt firmware for a program of this workspace: `firmware.elf` in the program's folder, else where cargo leaves
/// it, in the target folder that the program is in, else below the current folder. The last is returned also if it does not
/// exist.
#[must_use]
pub fn firmware_path(program: &Path) -> PathBuf {
    let folder = program.parent();
    let target = folder.and_then(Path::parent).map(built_firmware);
    let current = built_firmware(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| OsString::from("target")));
    let prebuilt = folder.map(|folder| folder.join(PREBUILT));
    prebuilt.into_iter().chain(target).find(|path| path.is_file()).unwrap_or(current)
}

/// Path of the firmware that cargo builds, below a target folder.
#[must_use]
pub fn built_firmware(target: impl AsRef<Path>) -> PathBuf {
    target.as_ref().join("thumbv7m-none-eabi").join("firmware").join("firmware")
}
