//! `proprio calibrate`.

use std::io::Write;
use std::path::{Path, PathBuf};

use proprio_calibration::calibrate::{Calibration, CalibrationOptions, HysteresisMode, MapMode, calibrate};
use proprio_session::{LoadedTable, OutputFile, today};

use super::truth;
use super::warnings::{checked, warn_of_defects};
use crate::args::{CalibrateArgs, HysteresisName, MapName};
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;
use crate::text_tables;

pub fn run(args: &CalibrateArgs) -> Result<(), Error> {
    let arm = LoadedTable::load(&args.arm)?;
    let inputs: Vec<&Path> = args.sessions.iter().chain([&args.arm]).map(PathBuf::as_path).collect();
    let mut file = OutputFile::create(&args.output, &inputs, args.force.existing())?;
    let options = CalibrationOptions { maps: args.map.into(), hysteresis: args.hysteresis.into() };
    let calibration = calibrate(&args.sessions, &arm, options, &mut Bar::new());
    let table = |made: Option<&Calibration>| match made {
        Some(Calibration { table, .. }) => LoadedTable { file: table.clone(), path: &args.output },
        None => arm,
    };
    let mut calibration = checked(calibration, &args.sessions, table, |finding| !finding.is_later_tare())?;
    for (path, defects) in args.sessions.iter().zip(&calibration.defects) {
        warn_of_defects(path, defects);
    }
    let names: Vec<String> = args.sessions.iter().map(|session| session.display().to_string()).collect();
    calibration.truth.iter().for_each(truth::warn);
    for warning in &calibration.warnings {
        terminal::warn(&format_args!("{}: {warning}", names.join(", ")));
    }
    if let Some(record) = &mut calibration.table.calibration {
        record.date = Some(today());
    }
    file.write_all(calibration.table.to_toml().as_bytes()).map_err(|error| file.error(error))?;
    // Last, so that a command that fails leaves no file.
    let truth = calibration.truth.iter().map(truth::line).collect();
    let tables = [truth, text_tables::sensors(&calibration.sensors), text_tables::segments(&calibration.segments)];
    for text in tables.into_iter().chain(calibration.held_out.as_ref().map(text_tables::held_out)) {
        terminal::print_beside(Some(&args.output), &text)?;
    }
    terminal::eprint_line(&file.finish()?);
    Ok(())
}

impl From<MapName> for MapMode {
    fn from(name: MapName) -> Self {
        match name {
            MapName::Auto => Self::Auto,
            MapName::Curve => Self::Curve,
            MapName::Quadratic => Self::Quadratic,
        }
    }
}

impl From<HysteresisName> for HysteresisMode {
    fn from(name: HysteresisName) -> Self {
        match name {
            HysteresisName::Auto => Self::Auto,
            HysteresisName::Always => Self::Always,
            HysteresisName::Never => Self::Never,
        }
    }
}
