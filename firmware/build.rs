//! Determines the revision of the source.

use std::path::Path;
use std::process::Command;

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    println!("cargo::rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo::rerun-if-changed={}", root.join(".git/HEAD").display());
    println!("cargo::rustc-env=REVISION={}", revision(&root));
}

fn revision(root: &Path) -> String {
    let output = Command::new("git").current_dir(root).args(["rev-parse", "--short=12", "HEAD"]).output();
    let text =
        output.ok().filter(|output| output.status.success()).and_then(|output| String::from_utf8(output.stdout).ok());
    text.map_or_else(|| "unknown".to_owned(), |text| text.trim().to_owned())
}
