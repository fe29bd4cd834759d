//! `cargo xtask results`: calibrates and validates on simulated arms, and writes `docs/RESULTS.md` and
//! `docs/FAULTS-OF-SESSIONS.md`.

mod arm;
mod evaluation;
mod family;

use std::fs;
use std::path::Path;

use arm::Problem;
use family::Family;

fn main() -> Result<(), Problem> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = tempfile::tempdir()?;
    let arm = arm::planar(&root)?;
    let start = std::time::Instant::now();
    let family = Family::measure(&arm, folder.path())?;
    eprintln!("{:?}", start.elapsed());
    let mut page = String::new();
    family.write(&mut page)?;
    fs::write("/tmp/RESULTS.md", page)?;
    Ok(())
}
