//! The live page: an arm and its sensors in a browser on this machine, and recorded sessions.
//!
//! The link's events go two ways: to the hub, which makes rows of them and sends batches to every page, and to the
//! recording, which has a queue of its own. Each page has a bounded queue of messages as well, which drops the oldest: a
//! slow browser skips rows and delays no other.
//!
//! | file | purpose |
//! |---|---|
//! | `live.rs`, `host_replica.rs`, `page_row.rs` | the link's events as rows; drift and innovations by a replica of the board's estimator |
//! | `board_access.rs`, `table.rs` | waits for a board, and takes its table where none was given |
//! | `hub.rs`, `feed.rs`, `history.rs` | batches and status; the last ten minutes |
//! | `sweep.rs` | coverage of a sweep for a calibration, while it is recorded |
//! | `latency.rs` | latency from a sample to the screen |
//! | `recording.rs`, `sessions.rs` | recording and opening of sessions |
//! | `server.rs`, `socket.rs`, `actions.rs`, `body.rs`, `access.rs` | HTTP: the page, the feed, handlers of requests, their limits, access control |
//! | `running.rs`, `programs.rs` | a running monitor, for the user's other programs; handlers of their requests |
//! | `line_feed.rs`, `line_client.rs`, `line_message.rs` | the board's line for them: server, client, messages |
//! | `monitor_state.rs`, `app_state.rs` | state of the threads; state of the handlers |
//! | `plain.rs` | one line per second instead, for a terminal |
//! | `page/` | the page, embedded in the program |

mod access;
mod actions;
mod app_state;
mod board_access;
mod body;
mod error;
mod feed;
mod history;
mod host_replica;
mod hub;
mod latency;
mod line_client;
mod line_feed;
mod line_message;
mod live;
mod monitor_state;
mod page_row;
mod plain;
mod programs;
mod recording;
mod running;
mod server;
mod sessions;
mod socket;
mod sweep;
mod table;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use calibration_tables::CompiledTable;
use estimator_core::Q;
use proprio_check::Finding;
use proprio_link::{Link, ReceivedBytes, Subscription};
use proprio_server::{LocalServer, serve_connection};
use proprio_session::LoadedTable;
use telemetry::{Command, TICK_HZ};
use tokio::io::{AsyncRead, AsyncWrite};

pub use access::Token;
pub use error::Error;
pub use line_client::{LineClient, MonitoredLine};
pub use plain::Plain;
pub use running::{RunningMonitor, RunningMonitorError};

use app_state::AppState;
use board_access::BoardAccess;
use feed::ArmDescription;
use hub::Hub;
use monitor_state::MonitorState;
use page_row::ArmSize;
use running::Announcement;
use sessions::Sessions;

/// Options of a monitor.
#[derive(Debug)]
pub struct Options<'p> {
    /// Port of 127.0.0.1; 0: any free one.
    pub port: u16,
    /// Table of the arm; `None`: that of the board, and of each recording.
    pub table: Option<LoadedTable<'p>>,
    /// Folder of recordings and sessions.
    pub folder: PathBuf,
    /// Token that a page needs to drive the board; `None`: no page may.
    pub token: Option<Token>,
    /// The session to open at once, where there is no board.
    pub session: Option<PathBuf>,
    /// Folder that only this user can read, in which the monitor of a board is announced to the user's programs.
    pub runtime_folder: Option<PathBuf>,
    /// Address of the board's stream to Foxglove, which is announced with it.
    pub stream: Option<SocketAddr>,
    /// Returns the remedy of an error, which the page shows with it.
    pub help: fn(&Error) -> String,
    /// Returns the text of a finding of the session check, with its remedy.
    pub finding_text: fn(&Finding) -> String,
}

/// A server that runs until it is dropped.
#[derive(Debug)]
pub struct Monitor {
    server: LocalServer,
    shared: Arc<MonitorState>,
}

impl Monitor {
    /// Starts to serve the data of a link, if there is one, and sessions.
    ///
    /// # Errors
    /// [`Error::Listen`], and [`Error::File`] on an arm description.
    pub fn start(live: Option<(Link, Subscription)>, options: Options) -> Result<Self, Error> {
        let port = options.port;
        let failed = |source| Error::Listen { port, source };
        let mut server = LocalServer::bind(port).map_err(failed)?;
        let address = server.address();
        if let Some(table) = &options.table {
            table.compile::<Q>(TICK_HZ)?;
        }
        let (link, events) = live.unzip();
        let folder = options.runtime_folder.clone();
        let stream = options.stream;
        let token = folder.as_ref().and_then(|_| Token::new().ok());
        let shared = Arc::new(shared(link, options, token.clone()));
        if let Some(events) = events {
            let access = BoardAccess { shared: Arc::clone(&shared), address, folder, token, stream };
            // Before the address is known to anybody, so that programs find the monitor from then on.
            let announcement = access.announce();
            server.spawn("board", move |stop| board(access, announcement, stop)).map_err(failed)?;
            let shared = Arc::clone(&shared);
            server.spawn("hub", move |stop| hub(&shared, events, stop)).map_err(failed)?;
        }
        let state = AppState { monitor: Arc::clone(&shared), port: address.port() };
        server.serve("server", |listener| server::serve(listener, server::router(state))).map_err(failed)?;
        Ok(Self { server, shared })
    }

    /// Its address.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.server.address()
    }

    /// Ends the monitor: vents the board, where a page could have driven it, and completes the recording. Returns its path.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::RecorderPanicked`] of a recording.
    pub fn finish(self) -> Result<Option<String>, Error> {
        if let (Some(link), Some(_)) = (&self.shared.link, &self.shared.token) {
            // A board that does not answer vents at its own deadline.
            let _ = link.request(Command::Disarm);
        }
        Ok(self.shared.finish_recording()?.map(|progress| progress.file))
    }
}

/// Serves one connection of a monitor without a board on any stream, which stands for one to the port in `options`. Tests and
/// fuzzers use it.
pub async fn serve_stream<S>(options: Options<'_>, stream: S)
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let port = options.port;
    let state = AppState { monitor: Arc::new(shared(None, options, None)), port };
    serve_connection(stream, server::router(state), body::PART_TIMEOUT).await;
}

/// The state that the threads share.
fn shared(link: Option<Link>, options: Options, program_token: Option<Token>) -> MonitorState {
    let table = options.table.as_ref();
    // Until a board has sent its number of segments, the arm is that of the table.
    let size = ArmSize { segments: table.map_or(0, |table| table.file.segments.len()), regulators: 0 };
    let mut arm = ArmDescription::new(size, table.map(|table| &table.file));
    (arm.is_live, arm.allows_control) = (link.is_some(), options.token.is_some());
    let sessions = Sessions::new(options.folder, table, options.session, options.finding_text);
    arm.session = sessions.given();
    MonitorState::new(link, arm, options.token, program_token, sessions, options.help)
}

fn board(access: BoardAccess, announcement: Option<Announcement>, stop: &AtomicBool) {
    let shared = Arc::clone(&access.shared);
    if let Some(link) = &shared.link {
        access.run(link, announcement, stop);
    }
}

/// Runs the hub, and starts it again with each table that is taken from the board.
fn hub(shared: &Arc<MonitorState>, mut events: Subscription, stop: &AtomicBool) {
    let Some(link) = &shared.link else { return };
    let mut received: Option<Vec<ReceivedBytes>> = None;
    loop {
        let tables = shared.board_tables();
        let table = shared.sessions.table();
        // It was compiled when it was given, or by the board.
        let compiled = table.and_then(|table| table.loaded().compile::<Q>(TICK_HZ).ok());
        let config = compiled.as_ref().map(CompiledTable::config);
        let mut hub = Hub::new(Arc::clone(shared), events, config.as_ref(), shared.sessions.check());
        if let Some(received) = received.take() {
            hub.take_history(&received);
        }
        hub.run(link, || stop.load(Ordering::Relaxed) || shared.board_tables() != tables);
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let (since, history) = link.subscribe_with_history();
        (events, received) = (since, Some(history.unwrap_or_default()));
    }
}
