//! `proprio ports`.

use crate::args::Ports;
use crate::error::Error;
use crate::terminal;
use crate::text_tables as tables;

pub fn run(args: &Ports) -> Result<(), Error> {
    let ports = proprio_link::list()?;
    terminal::print(&if args.json { terminal::json(&ports) } else { tables::ports(&ports) })
}
