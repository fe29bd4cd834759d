//! `cargo xtask dist`: what users get, in `target/dist`.
//!
//! | file | what |
//! |---|---|
//! | `firmware.rs` | the firmware: its ELF file and its plain image |
//! | `programs.rs` | `proprio`, `proprio-ros2` and `virtual-due`, stripped, with the firmware and the reference arm's table, as a `.tar.gz` |
//! | `deb.rs` | the same as a Debian package, with manual pages, completions and the rule for the port |
//! | `wheel.rs` | the Python package with all of them |
//! | `checksums.rs`, `files.rs` | checksums of the files; copies |

mod checksums;
mod deb;
mod files;
mod firmware;
mod programs;
mod wheel;

use std::fs;
use std::path::Path;

use crate::tool::target;

/// Builds everything. Without a Python there is no wheel, without dpkg no Debian package.
pub fn run() -> Result<(), String> {
    let folder = target().join("dist");
    files::emptied(&folder)?;
    let mut written = firmware::write(&folder)?;
    let bundle = programs::Files::build(&written)?;
    written.push(programs::archive(&bundle, &folder)?);
    if deb::is_possible() {
        written.push(deb::write(&bundle, &folder)?);
    } else {
        println!("SKIPPED: no dpkg-deb here; the Debian package was not built");
    }
    match wheel::Python::find() {
        Some(python) => written.push(wheel::write(&python, &bundle, &folder)?),
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
