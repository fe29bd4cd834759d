//! `cargo xtask results`: calibrates and validates on simulated arms, and writes `docs/explanation/results.md` and
//! `docs/explanation/faults-of-sessions.md`.

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
    fs::write(root.join("docs/explanation/results.md"), results.to_markdown()?)?;
    fs::write(root.join("docs/explanation/faults-of-sessions.md"), faults.to_markdown()?)?;
    Ok(())
}
