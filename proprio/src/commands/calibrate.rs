//! `proprio calibrate`.

use std::io::Write;

use proprio::calibrate::{CalibrationOptions, calibrate};
use proprio::error::Error;
use proprio::output::OutputFile;
use proprio::replay::NamedTable;

use crate::cli::Calibrate;
use crate::tables;

pub fn run(args: &Calibrate) -> Result<(), Error> {
    let arm = NamedTable::load(&args.arm)?;
    let mut file = OutputFile::create(&args.output, &[&args.session, &args.arm])?;
    let options = CalibrationOptions { maps: args.map, hysteresis: args.hysteresis };
    let calibration = calibrate(&args.session, &arm, options)?;
    for warning in &calibration.warnings {
        super::warn(&format_args!("{}: {warning}", args.session.display()));
    }
    file.write_all(calibration.table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    super::print(&tables::sensors(&calibration.sensors))?;
    super::print(&tables::segments(&calibration.segments))?;
    file.finish()
}
