//! From the arguments to a link.

use estimator_core::Q;
use proprio::error::Error;
use proprio::link::{Link, PortSource, Source, VirtualDue};
use proprio::replay::NamedTable;
use telemetry::TICK_HZ;

use crate::cli::LinkArgs;

/// The table that was given, and a link to the board that was.
pub fn open(args: &LinkArgs) -> Result<(Option<NamedTable<'_>>, Link), Error> {
    let table = args.table.as_deref().map(NamedTable::load).transpose()?;
    let checksum = table.as_ref().map(|table| Ok::<_, Error>(table.bake::<Q>(TICK_HZ)?.checksum())).transpose()?;
    let source: Box<dyn Source> = if args.emulated {
        Box::new(VirtualDue { firmware: args.firmware.clone(), scenario: args.scenario, seed: args.seed })
    } else {
        Box::new(PortSource::new(args.port.clone(), args.baud))
    };
    Ok((table, Link::start(source, checksum)?))
}
