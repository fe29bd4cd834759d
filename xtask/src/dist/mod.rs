//! `cargo xtask dist`: what users get, in `target/dist`.
//!
//! | file | what |
//! |---|---|
//! | `firmware.rs` | the firmware: its ELF file and its plain image |
//! | `programs.rs` | `proprio` and `virtual-due`, stripped, with the firmware and the reference arm's table, as a `.tar.gz` |
//! | `wheel.rs` | the Python package with all of them |
//! | `checksums.rs` | checksums of the files |

mod checksums;
mod firmware;
mod programs;
mod wheel;

use std::fs;
use std::path::{Path, PathBuf};

use crate::tool::target;

/// Builds everything. Without a Python there is no wheel.
pub fn run() -> Result<(), String> {
    let folder = target().join("dist");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut written = firmware::write(&folder)?;
    let files = programs::Files::build(&written)?;
    written.push(programs::archive(&files, &folder)?);
    match wheel::Python::find() {
        Some(python) => written.push(wheel::write(&python, &files, &folder)?),
        None => println!("SKIPPED: no python3 with venv and pip here; the wheel was not built"),
    }
    checksums::write(&written, &folder)?;
    for path in &written {
        println!("{}: {} bytes", path.display(), size(path)?);
    }
    Ok(())
}

fn size(path: &Path) -> Result<u64, String> {
    fs::metadata(path).map(|found| found.len()).map_err(|error| format!("{}: {error}", path.display()))
}

/// Copies a file into a folder and returns its new path.
fn copy(from: &Path, folder: &Path, name: &str) -> Result<PathBuf, String> {
    let to = folder.join(name);
    fs::copy(from, &to).map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
    Ok(to)
}

/// An empty folder of this path.
fn emptied(path: &Path) -> Result<(), String> {
    let is_missing = !path.exists();
    let removed = if is_missing { Ok(()) } else { fs::remove_dir_all(path) };
    removed.and_then(|()| fs::create_dir_all(path)).map_err(|error| format!("{}: {error}", path.display()))
}
