//! `proprio convert`.

use proprio_session::convert::convert;

use crate::args::ConvertArgs;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::terminal;

pub fn run(args: &ConvertArgs) -> Result<(), Error> {
    for left_out in convert(&args.input, &args.output, &mut Bar::new())? {
        terminal::warn(&format_args!("{}: {left_out}", args.output.display()));
    }
    Ok(())
}
