//! `proprio ports`.

use proprio::error::Error;
use proprio::link;

use crate::cli::Ports;
use crate::tables;

pub fn run(args: &Ports) -> Result<(), Error> {
    let ports = link::list()?;
    super::print(&if args.json { super::json(&ports) } else { tables::ports(&ports) })
}
