//! The firmware: its ELF file and its plain image.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use firmware_image::image;

use crate::board::{TARGET, add_target};
use crate::tool::{cargo, root, target};

/// Builds the firmware with its profile, and writes its ELF file and its plain image.
pub fn write(folder: &Path) -> Result<Vec<PathBuf>, String> {
    add_target()?;
    let revision = revision()?;
    let (mut elf, mut image) = build()?;
    if !image.windows(revision.len()).any(|bytes| bytes == revision.as_bytes()) {
        // Cargo does not notice a commit that changes nothing of the firmware; its `Hello` carries the revision.
        cargo(&["clean", "--package", "firmware", "--profile", "firmware", "--target", TARGET], &[])?;
        (elf, image) = build()?;
    }
    println!("firmware {} ({revision}), {} bytes of flash", env!("CARGO_PKG_VERSION"), image.len());
    let files = [("firmware.elf", elf), ("firmware.bin", image)];
    let write = |(name, bytes): (&str, Vec<u8>)| {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

/// The firmware's ELF file and its plain image.
fn build() -> Result<(Vec<u8>, Vec<u8>), String> {
    cargo(&["build", "--locked", "--profile", "firmware", "--package", "firmware", "--target", TARGET], &[])?;
    let path = target().join(TARGET).join("firmware").join("firmware");
    let elf = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let image = image(&elf).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok((elf, image))
}

/// The revision of the source, as the firmware's build script determines it.
fn revision() -> Result<String, String> {
    let output = Command::new("git").current_dir(root()).args(["rev-parse", "--short=12", "HEAD"]).output();
    let output = output.map_err(|error| format!("git: {error}"))?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    } else {
        Err(format!("git rev-parse: {}", output.status))
    }
}
