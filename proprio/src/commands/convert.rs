//! `proprio convert`.

use proprio::convert::convert;
use proprio::error::Error;

use crate::cli::Convert;

pub fn run(args: &Convert) -> Result<(), Error> {
    for left_out in convert(&args.input, &args.output)? {
        super::warn(&format_args!("{}: {left_out}", args.output.display()));
    }
    Ok(())
}
