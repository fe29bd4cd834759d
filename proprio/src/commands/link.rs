//! From the arguments to a link.

use estimator_core::Q;
use proprio::error::Error;
use proprio::link::{Link, PortSource, Source, Subscription, VirtualDue};
use proprio::replay::NamedTable;
use telemetry::TICK_HZ;

use crate::cli::LinkArgs;

/// The table that was given, a link to the board that was, and all that it will say.
pub fn open(args: &LinkArgs) -> Result<(Option<NamedTable<'_>>, Link, Subscription), Error> {
    let table = args.table.as_deref().map(NamedTable::load).transpose()?;
    let checksum = table.as_ref().map(|table| Ok::<_, Error>(table.bake::<Q>(TICK_HZ)?.checksum())).transpose()?;
    let source: Box<dyn Source> = if args.emulated {
        Box::new(VirtualDue { firmware: args.firmware.clone(), scenario: args.scenario, seed: args.seed })
    } else {
        Box::new(PortSource::new(args.port.clone(), args.baud))
    };
    let (link, events) = Link::start(source, checksum)?;
    Ok((table, link, events))
}
