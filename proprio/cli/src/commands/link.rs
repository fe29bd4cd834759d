//! A link and its recording from the arguments.

use std::path::Path;

use estimator_core::Q;
use proprio_link::status::{Status, TIMEOUT_S};
use proprio_link::{FileRecorder, Link, PortSource, Source, Subscription, VirtualDue};
use proprio_session::{HostClock, LoadedTable};
use telemetry::TICK_HZ;

use crate::args::LinkArgs;
use crate::error::Error;
use crate::terminal;

/// The given table, a link to the given board, and a subscription to its events.
pub fn open(args: &LinkArgs) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    let table = args.table.as_deref().map(LoadedTable::load).transpose()?;
    let checksum = table.as_ref().map(|table| Ok::<_, Error>(table.compile::<Q>(TICK_HZ)?.checksum())).transpose()?;
    let source: Box<dyn Source> = if args.emulated {
        Box::new(VirtualDue { firmware: args.firmware.clone(), scenario: args.scenario, seed: args.seed })
    } else {
        Box::new(PortSource::new(args.port.clone(), args.baud))
    };
    let (link, events) = Link::start(source, checksum)?;
    Ok((table, link, events))
}

/// The status of the board, with a notice of the wait for it: a port without a board is silent.
pub fn status(link: &Link, events: &Subscription, table_given: bool) -> Result<Status, Error> {
    let port = link.state().port.unwrap_or_default();
    terminal::eprint_line(&format_args!("{port}: waiting for a board's messages, {TIMEOUT_S} s at most"));
    Ok(Status::of(link, events, table_given)?)
}

/// Begins a recording of the link in a new file, with the table attached.
pub fn recorder(path: &Path, link: &Link, table: Option<&LoadedTable>) -> Result<FileRecorder, Error> {
    let toml = table.map(LoadedTable::toml).transpose()?;
    Ok(FileRecorder::create(path, link, HostClock::new(), toml.as_deref())?)
}
