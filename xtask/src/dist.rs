//! `cargo xtask dist`: the firmware as users get it, in `target/dist`.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

use firmware_image::image;
use sha2::{Digest, Sha256};

use crate::board::{TARGET, add_target};
use crate::tool::{cargo, root, target};

/// Builds the firmware with its profile, and writes its ELF file, its plain image and the checksums of both.
pub fn run() -> Result<(), String> {
    add_target()?;
    let revision = revision()?;
    let (mut elf, mut image) = build()?;
    if !image.windows(revision.len()).any(|bytes| bytes == revision.as_bytes()) {
        // Cargo does not notice a commit that changes nothing of the firmware; its `Hello` carries the revision.
        cargo(&["clean", "--package", "firmware", "--profile", "firmware", "--target", TARGET], &[])?;
        (elf, image) = build()?;
    }
    let folder = target().join("dist");
    write(&elf, &image, &folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let (version, size) = (env!("CARGO_PKG_VERSION"), image.len());
    println!("firmware {version} ({revision}), {size} bytes of flash: {}", folder.display());
    Ok(())
}

/// The firmware's ELF file and its plain image.
fn build() -> Result<(Vec<u8>, Vec<u8>), String> {
    cargo(&["build", "--locked", "--profile", "firmware", "--package", "firmware", "--target", TARGET], &[])?;
    let path = target().join(TARGET).join("firmware").join("firmware");
    let elf = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let image = image(&elf).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok((elf, image))
}

fn write(elf: &[u8], image: &[u8], folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("firmware.elf"), elf)?;
    fs::write(folder.join("firmware.bin"), image)?;
    fs::write(folder.join("SHA256SUMS"), checksums(&[("firmware.elf", elf), ("firmware.bin", image)]))
}

/// Lines as `sha256sum --check` reads them.
fn checksums(files: &[(&str, &[u8])]) -> String {
    let mut lines = String::new();
    for (name, contents) in files {
        let digest = Sha256::digest(contents);
        digest.iter().for_each(|byte| write!(lines, "{byte:02x}").expect("memory takes it"));
        writeln!(lines, "  {name}").expect("memory takes it");
    }
    lines
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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::write;

    #[test]
    fn both_files_are_written_with_their_checksums_as_sha256sum_checks_them() {
        let folder = tempfile::tempdir().expect("there is room");
        let dist = folder.path().join("target").join("dist");
        write(b"abc", b"", &dist).expect("there is room");
        let read = |name: &str| fs::read_to_string(dist.join(name)).expect("it was written");
        assert_eq!((read("firmware.elf"), read("firmware.bin")), ("abc".to_owned(), String::new()));
        // The example of FIPS 180-4, and the digest of nothing.
        assert_eq!(
            read("SHA256SUMS"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  firmware.elf\n\
             e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  firmware.bin\n"
        );
    }
}
