//! `proprio monitor`.

use std::time::{Duration, Instant};

use proprio::error::Error;
use proprio::interrupt::Heed;
use proprio::link::{HostClock, Link, LinkError, Subscription, What};
use proprio::monitor::{Monitor, Options, Plain, Token};
use proprio::replay::NamedTable;
use proprio::session::SessionReader;

use super::link;
use crate::cli;

/// Longest time from one look at Ctrl-C to the next.
const LOOK: Duration = Duration::from_millis(50);
/// Time from one line of `--plain` to the next.
const LINE: Duration = Duration::from_secs(1);

pub fn run(args: &cli::Monitor) -> Result<(), Error> {
    if args.session.is_some() {
        return show(args);
    }
    let (table, link, events) = link::open(&args.link)?;
    let heed = Heed::interrupts();
    if args.plain {
        return plain(&link, &events, &heed);
    }
    let told = link.subscribe();
    let monitor = start(args, Some((link, events)), table)?;
    // Nothing follows an end, but what came until then can still be looked at.
    while !heed.is_requested() {
        if let Some(warning) = told.next(LOOK).and_then(|event| event.what.warning()) {
            super::warn(&warning);
        }
    }
    if let Some(file) = monitor.finish()? {
        super::say(&format_args!("{file}: recorded"));
    }
    Ok(())
}

/// A session without a board.
fn show(args: &cli::Monitor) -> Result<(), Error> {
    let table = args.link.table.as_deref().ok_or(Error::SessionWithoutTable)?;
    let table = NamedTable::load(table)?;
    if let Some(session) = &args.session {
        // What is wrong with it is better said here than on the page.
        SessionReader::open(session, &table.needs()?)?;
    }
    let heed = Heed::interrupts();
    let monitor = start(args, None, Some(table))?;
    while !heed.is_requested() {
        std::thread::sleep(LOOK);
    }
    drop(monitor);
    Ok(())
}

/// Starts the server, and prints where it is.
fn start(args: &cli::Monitor, live: Option<(Link, Subscription)>, table: Option<NamedTable>) -> Result<Monitor, Error> {
    let token = args.allow_control.then(Token::new).transpose().map_err(Error::Random)?;
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
    };
    let monitor = Monitor::start(live, options)?;
    super::print(&address(monitor.address().port()))?;
    Ok(monitor)
}

fn plain(link: &Link, events: &Subscription, heed: &Heed) -> Result<(), Error> {
    let (mut plain, clock) = (Plain::new(), HostClock::new());
    let mut due = Instant::now() + LINE;
    while !heed.is_requested() {
        if let Some(event) = events.next(due.saturating_duration_since(Instant::now()).min(LOOK)) {
            plain.take(&event);
            if let What::Ended(reason) = event.what {
                return Err(LinkError::Ended(reason).into());
            }
        }
        if Instant::now() >= due {
            due += LINE;
            super::print(&(plain.line(clock.now(), &link.state()) + "\n"))?;
        }
    }
    Ok(())
}
