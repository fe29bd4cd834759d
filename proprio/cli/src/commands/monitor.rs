//! `proprio monitor`.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use proprio_foxglove::FoxgloveServer;
use proprio_link::{EventKind, Link, LinkError, Subscription};
use proprio_monitor::{Monitor, Options, Plain, Token};
use proprio_session::{HostClock, LoadedTable, SessionReader, recorded_table};

use super::link;
use super::motion::Motion;
use super::warnings::with_remedy;
use crate::error::Error;
use crate::help::Help;
use crate::interrupt::ShutdownGuard;
use crate::{args, terminal};

/// Longest time between two checks for Ctrl-C.
const CHECK_PERIOD: Duration = Duration::from_millis(50);
/// Period of the lines of `--plain`.
const LINE: Duration = Duration::from_secs(1);

pub fn run(args: &args::MonitorArgs) -> Result<(), Error> {
    if args.session.is_some() {
        return show(args);
    }
    if args.plain {
        let (table, link, events) = link::open(&args.link)?;
        let _stream = link::stream(&args.foxglove, &link, table.as_ref())?;
        return plain(&link, &events, &ShutdownGuard::new());
    }
    let (table, link, events) = link::open_waiting(&args.link)?;
    if let Some(reason) = link.state().waiting {
        terminal::eprint_line(&format_args!("{reason}; waiting for it, and opening sessions meanwhile"));
    }
    let shutdown = ShutdownGuard::new();
    let warnings = link.subscribe();
    let stream = link::stream(&args.foxglove, &link, table.as_ref())?;
    let second_handle = link.second_handle();
    let monitor = start(args, Some((link, events)), table, stream.as_ref().map(FoxgloveServer::address))?;
    // The page moves an arm that it may control.
    let moves = args.link.emulated && !args.allow_control;
    let motion = moves.then(|| Motion::start(second_handle, &args.link)).transpose()?;
    // After the end of the line the page still shows the data until then.
    while !shutdown.is_requested() {
        if let Some(warning) = warnings.next(CHECK_PERIOD).and_then(|event| event.kind.warning()) {
            terminal::warn(&warning);
        }
    }
    drop(motion);
    if let Some(file) = monitor.finish()? {
        terminal::eprint_line(&format_args!("{file}: recorded"));
    }
    Ok(())
}

/// A session without a board.
fn show(args: &args::MonitorArgs) -> Result<(), Error> {
    let table = args.link.table.as_deref().map(LoadedTable::load).transpose()?;
    if let Some(session) = &args.session {
        // An error of the session is reported here, before the page is opened.
        let recorded = if table.is_none() { recorded_table(session)? } else { None };
        let recorded = recorded.map(|file| LoadedTable { file, path: session });
        let used = table.as_ref().or(recorded.as_ref()).ok_or(Error::SessionWithoutTable)?;
        SessionReader::open(session, &used.required_columns()?)?;
    }
    let shutdown = ShutdownGuard::new();
    let monitor = start(args, None, table, None)?;
    while !shutdown.is_requested() {
        std::thread::sleep(CHECK_PERIOD);
    }
    drop(monitor);
    Ok(())
}

/// Starts the server and prints its address.
fn start(
    args: &args::MonitorArgs,
    live: Option<(Link, Subscription)>,
    table: Option<LoadedTable>,
    stream: Option<SocketAddr>,
) -> Result<Monitor, Error> {
    let token = args.allow_control.then(Token::new).transpose().map_err(proprio_monitor::Error::Random)?;
    let address = |port: u16| match &token {
        Some(token) => format!("http://127.0.0.1:{port}/#token={token}\n"),
        None => format!("http://127.0.0.1:{port}/\n"),
    };
    let options = Options {
        port: args.listen,
        table,
        folder: args.folder.clone(),
        token: token.clone(),
        session: args.session.clone(),
        runtime_folder: link::runtime_folder(),
        stream,
        help: Help::help,
        finding_text: with_remedy,
    };
    let monitor = Monitor::start(live, options)?;
    terminal::print(&address(monitor.address().port()))?;
    Ok(monitor)
}

fn plain(link: &Link, events: &Subscription, shutdown: &ShutdownGuard) -> Result<(), Error> {
    let (mut plain, clock) = (Plain::new(), HostClock::new());
    let mut due = Instant::now() + LINE;
    while !shutdown.is_requested() {
        if let Some(event) = events.next(due.saturating_duration_since(Instant::now()).min(CHECK_PERIOD)) {
            plain.take(&event);
            if let EventKind::Ended(reason) = event.kind {
                return Err(LinkError::Ended(reason).into());
            }
        }
        if Instant::now() >= due {
            due += LINE;
            terminal::print(&(plain.line(clock.now(), &link.state()) + "\n"))?;
        }
    }
    Ok(())
}
