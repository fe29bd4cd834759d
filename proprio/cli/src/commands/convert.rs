//! `proprio convert`.

use proprio_session::convert::{Converted, convert};

use crate::args::ConvertArgs;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;

pub fn run(args: &ConvertArgs) -> Result<(), Error> {
    let Converted { written, left_out } = convert(&args.input, &args.output, args.force.existing(), &mut Bar::new())?;
    for left_out in left_out {
        terminal::warn(&format_args!("{}: {left_out}", written.path.display()));
    }
    terminal::eprint_line(&written);
    Ok(())
}
