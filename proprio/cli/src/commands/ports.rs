//! `proprio ports`.

use crate::args::PortsArgs;
use crate::error::Error;
use crate::terminal;
use crate::text_tables;

pub fn run(args: &PortsArgs) -> Result<(), Error> {
    if args.udev {
        return terminal::print(&proprio_link::udev_rules());
    }
    let ports = proprio_link::list()?;
    terminal::print(&if args.json { terminal::json(&ports) } else { text_tables::ports(&ports) })
}
