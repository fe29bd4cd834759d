//! The simulated arm and its wiring, from an arm description or a table.

use std::path::Path;

use board_table::Wiring;
use calibration_tables::ArmFile;
use rig_twin::{Layout, Scenario, Setup};
use virtual_due::rig::WiredRig;

use super::error::Error;

/// The rig in a session of a scenario and a seed: the arm of a file in the file's wiring, or the reference arm in its own.
pub fn rig(path: Option<&Path>, scenario: Scenario, seed: u64) -> Result<WiredRig, Error> {
    let Some(path) = path else { return Ok(WiredRig::new(scenario, seed)) };
    let shown = || path.display().to_string();
    let file = ArmFile::load(path).map_err(|error| Error::Arm { path: shown(), error })?;
    let layout = Layout::of_file(&file).map_err(|error| Error::Layout { path: shown(), error })?;
    // The twin has room for no longer arm than the board.
    let wiring = file.wiring().unwrap_or_else(|| Wiring::reference(layout.segments().len()));
    Ok(WiredRig::of(&Setup { layout, ..Setup::new(scenario, seed) }, &wiring))
}
