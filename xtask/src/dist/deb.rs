//! The Debian package of the programs, by `dpkg-deb`.
//!
//! `/usr/lib/proprio` holds all files that belong together, as the archive does; `/usr/bin` has links to the programs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::files::{copy, emptied};
use super::programs::Files;
use crate::tool::{check, output, target};

/// The shells, as `proprio completions` names them, and the files of their completions.
const COMPLETIONS: [(&str, &str); 3] = [
    ("bash", "usr/share/bash-completion/completions/proprio"),
    ("zsh", "usr/share/zsh/vendor-completions/_proprio"),
    ("fish", "usr/share/fish/vendor_completions.d/proprio.fish"),
];

/// Returns whether the package can be built here.
pub fn is_possible() -> bool {
    let version = Command::new("dpkg-deb").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    version.is_ok_and(|status| status.success())
}

/// Writes `proprio_VERSION_ARCHITECTURE.deb` and returns its path.
pub fn write(files: &Files, folder: &Path) -> Result<PathBuf, String> {
    let tree = target().join("deb");
    emptied(&tree)?;
    let library = tree.join("usr/lib/proprio");
    make(&library)?;
    for file in [&files.proprio, &files.ros2].into_iter().chain(&files.companions) {
        copy(file, &library)?;
    }
    make(&tree.join("usr/bin"))?;
    for program in ["proprio", "proprio-ros2", "virtual-due"] {
        link(&format!("../lib/proprio/{program}"), &tree.join("usr/bin").join(program))?;
    }
    let print = |arguments: &[&str]| output(Command::new(&files.proprio).args(arguments));
    for (shell, path) in COMPLETIONS {
        put(&tree.join(path), &print(&["completions", shell])?)?;
    }
    put(&tree.join("usr/lib/udev/rules.d/60-proprio.rules"), &print(&["ports", "--udev"])?)?;
    manual(&files.proprio, &tree.join("usr/share/man/man1"))?;
    put(&tree.join("usr/share/doc/proprio/copyright"), COPYRIGHT.as_bytes())?;
    let architecture = output(Command::new("dpkg").arg("--print-architecture"))?;
    let architecture = String::from_utf8_lossy(&architecture).trim().to_owned();
    put(&tree.join("DEBIAN/control"), control(&architecture, kilobytes(&tree)?, &libc()?).as_bytes())?;
    let package = folder.join(format!("proprio_{}_{architecture}.deb", env!("CARGO_PKG_VERSION")));
    check(Command::new("dpkg-deb").args(["--root-owner-group", "-Zxz", "--build"]).arg(&tree).arg(&package))?;
    Ok(package)
}

/// The manual pages, compressed as Debian has them.
fn manual(proprio: &Path, folder: &Path) -> Result<(), String> {
    check(Command::new(proprio).arg("man").arg(folder))?;
    let pages = fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    check(Command::new("gzip").args(["-9", "--no-name"]).args(pages.flatten().map(|entry| entry.path())))
}

/// The control file; `kilobytes` is the size when installed, `libc` the oldest C library.
fn control(architecture: &str, kilobytes: u64, libc: &str) -> String {
    format!(
        "Package: proprio\n\
         Version: {version}\n\
         Architecture: {architecture}\n\
         Maintainer: The proprio contributors\n\
         Section: science\n\
         Priority: optional\n\
         Installed-Size: {kilobytes}\n\
         Depends: libc6 (>= {libc}), libgcc-s1\n\
         Recommends: bossa-cli, udev\n\
         Description: shape of a soft robot arm from its bend sensors and IMUs\n\
         \x20Firmware for the Arduino Due with its table, and the tools to calibrate,\n\
         \x20tune, record, replay, watch and report sessions of an arm. An emulated\n\
         \x20Due runs the firmware without hardware: proprio demo.\n",
        version = env!("CARGO_PKG_VERSION"),
    )
}

/// Version of the C library here, which has all that the programs use.
fn libc() -> Result<String, String> {
    let text = output(Command::new("getconf").arg("GNU_LIBC_VERSION"))?;
    let text = String::from_utf8_lossy(&text);
    text.split_whitespace()
        .last()
        .map(str::to_owned)
        .ok_or_else(|| "getconf gives no version of the C library".to_owned())
}

/// Size of all files below a folder, kB of 1024 bytes.
fn kilobytes(folder: &Path) -> Result<u64, String> {
    let text = output(Command::new("du").args(["--apparent-size", "--summarize", "--block-size=1024"]).arg(folder))?;
    let text = String::from_utf8_lossy(&text);
    let number = text.split_whitespace().next().and_then(|number| number.parse().ok());
    number.ok_or_else(|| format!("{}: its size cannot be read", folder.display()))
}

fn make(folder: &Path) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))
}

/// Writes a file and the folders above it.
fn put(path: &Path, content: &[u8]) -> Result<(), String> {
    path.parent().map_or(Ok(()), make)?;
    fs::write(path, content).map_err(|error| format!("{}: {error}", path.display()))
}

fn link(to: &str, path: &Path) -> Result<(), String> {
    check(Command::new("ln").arg("--symbolic").arg(to).arg(path))
}

const COPYRIGHT: &str = "\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: proprio

Files: *
Copyright: The proprio contributors
License: MIT or Apache-2.0
 At your choice: both texts are in /usr/lib/proprio, LICENSE-MIT and
 LICENSE-APACHE.
";
