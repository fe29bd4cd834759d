//! A link and its recording from the arguments.

use std::path::{Path, PathBuf};

use calibration_tables::{ArmFile, PLANAR_6_TABLE};
use estimator_core::Q;
use proprio_foxglove::FoxgloveServer;
use proprio_link::status::{Status, TIMEOUT_S};
use proprio_link::table::{StoredTable, TableImageError};
use proprio_link::{
    FileRecorder, Flash, Link, LinkError, PortSource, ReceivedBytes, Source, Subscription, VirtualDue, find_due, list,
};
use proprio_monitor::{MonitoredLine, RunningMonitor};
use proprio_session::{HostClock, LoadedTable};
use telemetry::TICK_HZ;

use crate::args::{FoxgloveArgs, LinkArgs};
use crate::error::Error;
use crate::terminal;

/// A link to a board, on its line or through the running monitor that has it.
pub struct Board<'a> {
    /// The table that was given.
    pub table: Option<LoadedTable<'a>>,
    pub link: Link,
    /// Its events: from the first byte on, or behind the history.
    pub events: Subscription,
    /// The bytes from the last start of the board's estimator on, of a monitor that holds them.
    pub history: Option<Vec<ReceivedBytes>>,
}

/// A link to the given board, through the running monitor that has its line if there is one. `with_history`: for a recording.
pub fn open_shared(args: &LinkArgs, with_history: bool) -> Result<Board<'_>, Error> {
    let Some(monitor) = monitor(args) else {
        let (table, link, events) = open(args)?;
        return Ok(Board { table, link, events, history: None });
    };
    let (table, checksum) = given_table(args)?;
    let MonitoredLine { client, name, history } = monitor.line(with_history)?;
    let received = history.as_deref().unwrap_or_default();
    let (link, events) = Link::start_relayed(Box::new(client), name.as_deref(), received, checksum)?;
    Ok(Board { table, link, events, history })
}

/// The given table, a link to the given board, and a subscription to its events.
pub fn open(args: &LinkArgs) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    open_by(args, Link::start)
}

/// The same for a link of which recordings may begin later, and that waits for a board.
pub fn open_waiting(args: &LinkArgs) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    open_by(args, Link::start_waiting)
}

/// Starts a link on the board's line, with the checksum of its table.
type Start = fn(Box<dyn Source>, Option<u32>) -> Result<(Link, Subscription), LinkError>;

fn open_by(args: &LinkArgs, start: Start) -> Result<(Option<LoadedTable<'_>>, Link, Subscription), Error> {
    let (table, checksum) = given_table(args)?;
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

/// The given table, and its checksum.
fn given_table(args: &LinkArgs) -> Result<(Option<LoadedTable<'_>>, Option<u32>), Error> {
    let table = args.table.as_deref().map(LoadedTable::load).transpose()?;
    let checksum = table.as_ref().map(checksum).transpose()?;
    Ok((table, checksum))
}

fn checksum(table: &LoadedTable) -> Result<u32, Error> {
    Ok(table.compile::<Q>(TICK_HZ)?.checksum())
}

/// Checksum of the table in a file.
pub fn table_checksum(path: &Path) -> Result<u32, Error> {
    checksum(&LoadedTable::load(path)?)
}

/// Folder of this user alone, for what running programs announce to each other.
pub fn runtime_folder() -> Option<PathBuf> {
    if cfg!(any(windows, target_os = "macos")) {
        // The temporary folder there is the user's own.
        return Some(std::env::temp_dir());
    }
    std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from)
}

/// The running monitor that has the board's line, if there is one; reports that it is used.
pub fn monitor(args: &LinkArgs) -> Option<RunningMonitor> {
    if args.emulated {
        return None;
    }
    let due = || Some(find_due(&list().ok()?).ok()?.name.clone());
    let port = args.port.clone().or_else(due)?;
    let monitor = RunningMonitor::find(&runtime_folder()?, &port)?;
    terminal::eprint_line(&format_args!("{port}: through the monitor at http://{}", monitor.address()));
    Some(monitor)
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

/// Begins a recording of the board in a new file, with the table attached, behind the history.
pub fn recorder(path: &Path, board: &Board) -> Result<FileRecorder, Error> {
    let toml = board.table.as_ref().map(LoadedTable::toml).transpose()?;
    let mut recorder = FileRecorder::create(path, &board.link, HostClock::new(), toml.as_deref())?;
    recorder.history(board.history.as_deref().unwrap_or_default())?;
    Ok(recorder)
}

/// Starts the live stream for other viewers, where it is asked for, and prints its address.
pub fn stream(args: &FoxgloveArgs, link: &Link, table: Option<&LoadedTable>) -> Result<Option<FoxgloveServer>, Error> {
    let Some(port) = args.foxglove else { return Ok(None) };
    let server = FoxgloveServer::start(link.subscribe(), port, table.map(|table| &table.file))?;
    terminal::eprint_line(&format_args!("Foxglove, Lichtblick, PlotJuggler: ws://{}", server.address()));
    Ok(Some(server))
}
