//! `cargo xtask results`: calibrates and validates on simulated arms, and writes `docs/RESULTS.md` and
//! `docs/FAULTS-OF-SESSIONS.md`.

mod arm;
mod contact;
mod day;
mod evaluation;
mod family;
mod faults;
mod motions;
mod page;
mod real_drift;
mod rigs;

use std::fs;
use std::path::Path;

use arm::Problem;
use faults::Faults;
use page::Results;

fn main() -> Result<(), Problem> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = tempfile::tempdir()?;
    let results = Results::measure(&root, folder.path())?;
    let faults = Faults::measure(&results.family)?;
    fs::write(root.join("docs/RESULTS.md"), results.to_markdown()?)?;
    fs::write(root.join("docs/FAULTS-OF-SESSIONS.md"), faults.to_markdown()?)?;
    Ok(())
}
