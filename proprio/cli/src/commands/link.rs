//! A link and its recording from the arguments.

use std::path::Path;

use calibration_tables::{ArmFile, PLANAR_6_TABLE};
use estimator_core::Q;
use proprio_foxglove::FoxgloveServer;
use proprio_link::status::{Status, TIMEOUT_S};
use proprio_link::table::{StoredTable, TableImageError};
use proprio_link::{FileRecorder, Flash, Link, LinkError, PortSource, Source, Subscription, VirtualDue};
use proprio_session::{HostClock, LoadedTable};
use telemetry::TICK_HZ;

use crate::args::{FoxgloveArgs, LinkArgs};
use crate::error::Error;
use crate::terminal;

/// The given table, a link to the given board, and a subscription to its events.
pub fn open(args: &LinkArgs) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    open_by(args, Link::start)
}

/// The same for a link of which recordings may begin later.
pub fn open_with_history(args: &LinkArgs) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    open_by(args, Link::start_with_history)
}

/// Starts a link on the board's line, with the checksum of its table.
type Start = fn(Box<dyn Source>, Option<u32>) -> Result<(Link, Subscription), LinkError>;

fn open_by(args: &LinkArgs, start: Start) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    let table = args.table.as_deref().map(LoadedTable::load).transpose()?;
    let checksum = table.as_ref().map(|table| Ok::<_, Error>(table.compile::<Q>(TICK_HZ)?.checksum())).transpose()?;
    let source: Box<dyn Source> = if args.emulated {
        let flash = args.flash.clone().map_or_else(|| flash_with(table.as_ref()), |path| Ok(Flash::File(path)))?;
        let arm = args.arm.clone().or_else(|| args.table.clone());
        Box::new(VirtualDue { firmware: args.firmware.clone(), scenario: args.scenario, seed: args.seed, arm, flash })
    } else {
        Box::new(PortSource::new(args.port.clone(), args.baud))
    };
    let (link, events) = start(source, checksum)?;
    Ok((table, link, events))
}

/// The status of the board, with a notice of the wait for it: a port without a board is silent.
pub fn status(link: &Link, events: &Subscription, table_given: bool) -> Result<Status, Error> {
    let port = link.state().port.unwrap_or_default();
    terminal::eprint_line(&format_args!("{port}: waiting for a board's messages, {TIMEOUT_S} s at most"));
    Ok(Status::of(link, events, table_given)?)
}

/// The flash of an emulated board with the table that was given, or that of the reference arm.
fn flash_with(table: Option<&LoadedTable>) -> Result<Flash, Error> {
    let stored = match table {
        Some(table) => stored(table)?,
        None => ArmFile::parse(PLANAR_6_TABLE)
            .map_err(TableImageError::File)
            .and_then(|file| StoredTable::new(&file, PLANAR_6_TABLE.as_bytes()))
            .map_err(|source| Error::TableImage { name: "the reference arm's table".to_owned(), source })?,
    };
    Ok(Flash::Table(stored))
}

/// The form in which the board stores a table.
pub fn stored(table: &LoadedTable) -> Result<StoredTable, Error> {
    StoredTable::new(&table.file, &table.toml()?)
        .map_err(|source| Error::TableImage { name: table.path.display().to_string(), source })
}

/// Begins a recording of the link in a new file, with the table attached.
pub fn recorder(path: &Path, link: &Link, table: Option<&LoadedTable>) -> Result<FileRecorder, Error> {
    let toml = table.map(LoadedTable::toml).transpose()?;
    Ok(FileRecorder::create(path, link, HostClock::new(), toml.as_deref())?)
}

/// Starts the live stream for other viewers, where it is asked for, and prints its address.
pub fn stream(args: &FoxgloveArgs, link: &Link, table: Option<&LoadedTable>) -> Result<Option<FoxgloveServer>, Error> {
    let Some(port) = args.foxglove else { return Ok(None) };
    let server = FoxgloveServer::start(link.subscribe(), port, table.map(|table| &table.file))?;
    terminal::eprint_line(&format_args!("Foxglove, Lichtblick, PlotJuggler: ws://{}", server.address()));
    Ok(Some(server))
}
