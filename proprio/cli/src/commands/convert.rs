//! `proprio convert`.

use std::path::Path;

use proprio_analysis::estimate_recording;
use proprio_session::convert::{Converted, convert};
use proprio_session::{FileFormat, Header, LoadedTable};

use super::warnings::warn_of_defects;
use crate::args::ConvertArgs;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;

pub fn run(args: &ConvertArgs) -> Result<(), Error> {
    let Converted { written, left_out } = match &args.table {
        Some(table) => with_estimates(args, table)?,
        None => convert(&args.input, &args.output, args.force.existing(), &mut Bar::new())?,
    };
    for left_out in left_out {
        terminal::warn(&format_args!("{}: {left_out}", written.path.display()));
    }
    terminal::eprint_line(&written);
    Ok(())
}

/// Converts a CSV to a recording with estimates.
fn with_estimates(args: &ConvertArgs, table: &Path) -> Result<Converted, Error> {
    let (input, output) = (&args.input, &args.output);
    let table = LoadedTable::load(table)?;
    let is_csv = Header::of(input)?.kind == FileFormat::Csv;
    if !is_csv || FileFormat::of_output(output) != Some(FileFormat::Recording) {
        return Err(Error::EstimatesOfConversion { input: input.clone(), output: output.clone() });
    }
    let (converted, summary) =
        estimate_recording::convert(input, output, &table, args.force.existing(), &mut Bar::new())?;
    warn_of_defects(input, &summary.defects);
    Ok(converted)
}
