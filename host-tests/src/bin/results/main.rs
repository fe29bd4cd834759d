//! `cargo xtask results`: calibrates, tunes and validates on the simulated arm, and writes `docs/RESULTS.md`.

mod measure;
mod page;
mod runs;

use std::error::Error;
use std::fs;
use std::path::Path;

use measure::Results;

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = tempfile::tempdir()?;
    let results = Results::measure(&root, folder.path())?;
    fs::write(root.join("docs/RESULTS.md"), results.to_markdown())?;
    Ok(())
}
