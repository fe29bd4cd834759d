//! The files that belong to a program of this workspace: the emulated board's program and the firmware.
//!
//! Both are in the program's folder, as in an archive or a Python package, or in cargo's target folder.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Name of the firmware in a folder of programs.
const PREBUILT: &str = "firmware.elf";

/// Environment variable with the path of the emulated board's program, where it is in no usual folder.
const VARIABLE: &str = "PROPRIO_VIRTUAL_DUE";

/// The folder that [`set_program_folder`] has set.
static FOLDER: OnceLock<PathBuf> = OnceLock::new();

/// Sets the folder of the program's files, where it is not that of the executable: that of a Python package is Python. Only
/// the first call has an effect.
pub fn set_program_folder(folder: PathBuf) {
    // A second call would move files of a program that runs.
    let _ = FOLDER.set(folder);
}

/// The folder of the program's files.
fn program_folder() -> Option<PathBuf> {
    let own = || Some(env::current_exe().ok()?.canonicalize().ok()?.parent()?.to_owned());
    FOLDER.get().cloned().or_else(own)
}

/// Path of the emulated board's program: named by the variable, in the program's folder, in cargo's folder for the dev profile,
/// or on the PATH.
pub(crate) fn virtual_due_path() -> Option<PathBuf> {
    let name = format!("virtual-due{}", env::consts::EXE_SUFFIX);
    let own = program_folder();
    let built = own.as_deref().and_then(Path::parent).map(|target| target.join("debug"));
    let path = env::var_os("PATH").unwrap_or_default();
    let folders = own.clone().into_iter().chain(built).chain(env::split_paths(&path));
    let named = env::var_os(VARIABLE).map(PathBuf::from);
    named.into_iter().chain(folders.map(|folder| folder.join(&name))).find(|program| program.is_file())
}

/// Path of the prebuilt firmware: `firmware.elf` in the program's folder or in that of the emulated board's program, else
/// where cargo leaves it, in the target folder that one of them is in, else below the current folder. The last is returned also
/// if it does not exist.
#[must_use]
pub fn firmware_path() -> PathBuf {
    let other = virtual_due_path().and_then(|program| program.parent().map(Path::to_owned));
    let folders: Vec<PathBuf> = program_folder().into_iter().chain(other).collect();
    let prebuilt = folders.iter().map(|folder| folder.join(PREBUILT));
    let built = folders.iter().filter_map(|folder| folder.parent()).map(built_firmware);
    let current = built_firmware(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| OsString::from("target")));
    prebuilt.chain(built).find(|path| path.is_file()).unwrap_or(current)
}

/// Path of the firmware that cargo builds, below a target folder.
#[must_use]
pub fn built_firmware(target: impl AsRef<Path>) -> PathBuf {
    target.as_ref().join("thumbv7m-none-eabi").join("firmware").join("firmware")
}
