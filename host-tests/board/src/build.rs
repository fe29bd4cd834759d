//! Builds what runs on the board.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::{env, fs};

/// The firmware's ELF, built as a user builds it.
///
/// # Panics
/// If it cannot be built; cargo's own message is on stderr.
pub fn firmware() -> &'static [u8] {
    static FIRMWARE: OnceLock<Vec<u8>> = OnceLock::new();
    FIRMWARE.get_or_init(|| elf("firmware", "firmware"))
}

/// The ELF of a package's binary for the board.
///
/// # Panics
/// If it cannot be built; cargo's own message is on stderr.
pub fn elf(package: &str, binary: &str) -> Vec<u8> {
    const TARGET: &str = "thumbv7m-none-eabi";
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(&root)
        .args(["build", "--quiet", "--profile", "firmware", "--package", package, "--bin", binary, "--target", TARGET])
        .status()
        .expect("cargo, which runs this, can be run");
    assert!(
        status.success(),
        "{package} does not build for {TARGET}: is the target installed (rustup target add {TARGET})?"
    );
    let target =
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(PathBuf::from(folder)));
    let path = target.join(TARGET).join("firmware").join(binary);
    fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
