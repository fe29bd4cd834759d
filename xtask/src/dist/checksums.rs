//! Checksums of the files.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Writes `SHA256SUMS` for files of the folder, as `sha256sum --check` reads it.
pub fn write(files: &[PathBuf], folder: &Path) -> Result<(), String> {
    let mut lines = String::new();
    for path in files {
        let contents = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let digest = Sha256::digest(contents);
        digest.iter().for_each(|byte| write!(lines, "{byte:02x}").expect("memory takes it"));
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        writeln!(lines, "  {name}").expect("memory takes it");
    }
    let path = folder.join("SHA256SUMS");
    fs::write(&path, lines).map_err(|error| format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::write;

    #[test]
    fn checksums_are_as_sha256sum_checks_them() {
        let folder = tempfile::tempdir().expect("there is room");
        let files = [("firmware.elf", &b"abc"[..]), ("firmware.bin", b"")].map(|(name, contents)| {
            let path = folder.path().join(name);
            fs::write(&path, contents).expect("there is room");
            path
        });
        write(&files, folder.path()).expect("there is room");
        // The example of FIPS 180-4, and the digest of nothing.
        assert_eq!(
            fs::read_to_string(folder.path().join("SHA256SUMS")).expect("it was written"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  firmware.elf\n\
             e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  firmware.bin\n"
        );
    }
}
