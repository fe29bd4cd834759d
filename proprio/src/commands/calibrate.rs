//! `proprio calibrate`.

use std::io::Write;
use std::path::{Path, PathBuf};

use proprio::calibrate::{CalibrationOptions, calibrate};
use proprio::error::Error;
use proprio::output::OutputFile;
use proprio::replay::NamedTable;

use crate::cli::Calibrate;
use crate::tables;

pub fn run(args: &Calibrate) -> Result<(), Error> {
    let arm = NamedTable::load(&args.arm)?;
    let inputs: Vec<&Path> = args.sessions.iter().chain([&args.arm]).map(PathBuf::as_path).collect();
    let mut file = OutputFile::create(&args.output, &inputs)?;
    let options = CalibrationOptions { maps: args.map, hysteresis: args.hysteresis };
    let calibration = calibrate(&args.sessions, &arm, options)?;
    let names: Vec<String> = args.sessions.iter().map(|session| session.display().to_string()).collect();
    for warning in &calibration.warnings {
        super::warn(&format_args!("{}: {warning}", names.join(", ")));
    }
    file.write_all(calibration.table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    super::print(&tables::sensors(&calibration.sensors))?;
    super::print(&tables::segments(&calibration.segments))?;
    if let Some(held_out) = &calibration.held_out {
        super::print(&tables::held_out(held_out))?;
    }
    file.finish()
}
