//! The live page: an arm and its sensors in a browser on this machine, and sessions that were recorded.
//!
//! The link's events go two ways: to the hub, which makes rows of them and sends batches to every page, and to the
//! recording, which has a queue of its own. Each page has a bounded queue of messages as well, which drops the oldest; a
//! browser that is slow loses pictures and holds up nobody.
//!
//! | file | what it is for |
//! |---|---|
//! | `live.rs`, `shadow.rs`, `row.rs` | what the link says, as rows; drift and innovations by an estimator beside the board's |
//! | `hub.rs`, `feed.rs`, `history.rs` | batches and status; the last ten minutes |
//! | `latency.rs` | from a sample to the screen |
//! | `recording.rs`, `sessions.rs` | sessions that are recorded, and opened |
//! | `server.rs`, `socket.rs`, `actions.rs`, `access.rs` | HTTP: the page, the feed, what a page asks for, and who may |
//! | `plain.rs` | a line a second instead, for a terminal |
//! | `page/` | the page itself, embedded in the program |

mod access;
mod actions;
mod error;
mod feed;
mod history;
mod hub;
mod latency;
mod live;
mod plain;
mod recording;
mod row;
mod server;
mod sessions;
mod shadow;
mod shared;
mod socket;

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use calibration_tables::CompiledTable;
use estimator_core::Q;
use proprio_link::{Link, Subscription};
use proprio_session::NamedTable;
use telemetry::{Command, SEGMENTS, TICK_HZ};

pub use access::Token;
pub use error::Error;
pub use plain::Plain;

use feed::Arm;
use hub::Hub;
use server::Server;
use sessions::Sessions;
use shared::Shared;

/// What a monitor shows, and where.
#[derive(Debug)]
pub struct Options<'p> {
    /// Port of 127.0.0.1; 0: any that is free.
    pub port: u16,
    /// Table of the arm: without it there is neither drift nor innovation, and no session can be opened.
    pub table: Option<NamedTable<'p>>,
    /// Where recordings are written, and sessions found.
    pub folder: PathBuf,
    /// What a page must know to drive the board; `None`: the board is only watched.
    pub token: Option<Token>,
    /// The session to open at once, where there is no board.
    pub session: Option<PathBuf>,
    /// The remedy of an error, which the page shows with it.
    pub help: fn(&Error) -> String,
}

/// A server that runs until it is dropped.
#[derive(Debug)]
pub struct Monitor {
    address: SocketAddr,
    shared: Arc<Shared>,
    stop: Arc<AtomicBool>,
    stop_server: Option<tokio::sync::oneshot::Sender<()>>,
    threads: Vec<JoinHandle<()>>,
}

impl Monitor {
    /// Starts to serve what a link says, if there is one.
    ///
    /// # Errors
    /// [`Error::Listen`], and [`Error::File`] on an arm description.
    pub fn start(live: Option<(Link, Subscription)>, options: Options) -> Result<Self, Error> {
        let port = options.port;
        let failed = |source| Error::Listen { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let compiled = options.table.as_ref().map(|table| table.compile::<Q>(TICK_HZ)).transpose()?;
        let (link, events) = live.unzip();
        let shared = Arc::new(shared(link, options));
        let stop = Arc::new(AtomicBool::new(false));
        let (stop_server, stopped) = tokio::sync::oneshot::channel();
        let mut monitor = Self { address, shared, stop, stop_server: Some(stop_server), threads: Vec::new() };
        if let Some(events) = events {
            let (shared, stop) = (Arc::clone(&monitor.shared), Arc::clone(&monitor.stop));
            monitor.spawn("hub", move || hub(&shared, events, compiled.as_ref(), &stop)).map_err(failed)?;
        }
        let server = Server { shared: Arc::clone(&monitor.shared), port: address.port() };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let work = async move {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            tokio::select! {
                served = axum::serve(listener, server::router(server)) => served,
                _ = stopped => Ok(()),
            }
        };
        let serve = move || {
            // That it ends early leaves nothing to be told to anybody.
            let _ = runtime.block_on(work);
            // A long session that is being opened is not waited for.
            runtime.shutdown_background();
        };
        monitor.spawn("server", serve).map_err(failed)?;
        Ok(monitor)
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
        self.threads.push(std::thread::Builder::new().name(name.to_owned()).spawn(work)?);
        Ok(())
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Ends it: vents the board, where a page could have driven it, and completes the recording. Gives its name.
    ///
    /// # Errors
    /// [`Error::File`] of a recording.
    pub fn finish(self) -> Result<Option<String>, Error> {
        if let (Some(link), Some(_)) = (&self.shared.link, &self.shared.token) {
            // A board that does not answer vents by itself.
            let _ = link.request(Command::Disarm);
        }
        Ok(self.shared.finish_recording()?.map(|progress| progress.file))
    }
}

impl Drop for Monitor {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(stop) = self.stop_server.take() {
            // It may have ended by itself.
            let _ = stop.send(());
        }
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// What the threads share, and what the page is told first.
fn shared(link: Option<Link>, options: Options) -> Shared {
    let table = options.table.as_ref();
    let table_segments = table.map(|table| table.file.segments.len());
    let segments = table_segments.filter(|_| link.is_none()).unwrap_or(SEGMENTS);
    // A table for another number of segments is not this arm's.
    let mut arm = Arm::new(segments, table.map(|table| &table.file).filter(|_| table_segments == Some(segments)));
    (arm.is_live, arm.allows_control) = (link.is_some(), options.token.is_some());
    arm.opens_sessions = table.is_some();
    let sessions = Sessions::new(options.folder, table, options.session);
    arm.session = sessions.given();
    Shared::new(link, arm, options.token, sessions, options.help)
}

fn hub(shared: &Arc<Shared>, events: Subscription, compiled: Option<&CompiledTable<Q>>, stop: &AtomicBool) {
    let table = compiled.map(CompiledTable::config);
    let table = table.as_ref().filter(|table| table.segments.len() == SEGMENTS);
    if let Some(link) = &shared.link {
        Hub::new(Arc::clone(shared), events, table).run(link, stop);
    }
}
