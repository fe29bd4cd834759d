//! `proprio align`.

use std::slice;

use proprio_calibration::align::{Alignment, AlignmentReport, ComparedSensors, Written, align};
use proprio_session::{Axis, BodySelection, LoadedTable, OutputFile};

use super::truth;
use super::warnings::{checked, warn_of_defects};
use crate::args::AlignArgs;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;

pub fn run(args: &AlignArgs) -> Result<(), Error> {
    let arm = LoadedTable::load(&args.arm)?;
    let mut file = OutputFile::create(&args.output, &[&args.session, &args.camera, &args.arm], args.force.existing())?;
    let bodies = BodySelection { names: args.bodies.clone(), up: args.up.map(Axis::from) };
    let alignment = align(&args.session, &args.camera, &bodies, &arm, &mut Bar::new());
    let alignment = checked(alignment, slice::from_ref(&args.session), |_| arm, |_| true)?;
    for (path, defects) in [&args.session, &args.camera].into_iter().zip(&alignment.defects) {
        warn_of_defects(path, defects);
    }
    truth::warn(alignment.truth());
    let written = alignment.write(&args.session, &mut file)?;
    // Last, so that a command that fails leaves no file.
    terminal::print_beside(Some(&args.output), &text(&alignment, written))?;
    terminal::eprint_line(&file.finish()?);
    Ok(())
}

fn text(alignment: &Alignment, Written { rows, with_truth }: Written) -> String {
    let report = &alignment.report;
    let lengths = alignment.truth().lengths.map_or_else(|| "-".to_owned(), |lengths| format!("{:.4}", lengths.scale));
    let sensors = match report.sensors {
        ComparedSensors::Imus => "IMUs",
        ComparedSensors::Bend => "bend sensors",
    };
    let AlignmentReport { offset_s, offset_error_ms, middle_s, skew_ppm, skew_error_ppm, .. } = report;
    let AlignmentReport { residual_ms, correlation, matched, .. } = report;
    let percent = with_truth as f64 / rows as f64 * 100.0;
    let bodies = alignment
        .bodies()
        .map_or_else(String::new, |names| format!("bodies       {}: from the base to the tip\n", names.join(", ")));
    format!(
        "{bodies}\
         offset       {offset_s:.4} s ± {offset_error_ms:.1} ms: camera less session, at {middle_s:.1} s of the session\n\
         skew         {skew_ppm:.1} ± {skew_error_ppm:.1} ppm: the camera's clock is faster\n\
         residual     {residual_ms:.1} ms RMS: what offset and skew leave, in pieces of 20 s\n\
         correlation  {correlation:.4}: {sensors} and camera\n\
         matched      {matched} moments, ten a second\n\
         lengths      {lengths} times those of the arm: what the markers fit\n\
         truth        {with_truth} of {rows} rows, {percent:.1} %\n"
    )
}
