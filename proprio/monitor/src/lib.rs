//! The live page: an arm and its sensors in a browser on this machine, and recorded sessions.
//!
//! The link's events go two ways: to the hub, which makes rows of them and sends batches to every page, and to the
//! recording, which has a queue of its own. Each page has a bounded queue of messages as well, which drops the oldest: a
//! slow browser skips rows and delays no other.
//!
//! | file | purpose |
//! |---|---|
//! | `live.rs`, `host_replica.rs`, `page_row.rs` | the link's events as rows; drift and innovations by a replica of the board's estimator |
//! | `hub.rs`, `feed.rs`, `history.rs` | batches and status; the last ten minutes |
//! | `latency.rs` | latency from a sample to the screen |
//! | `recording.rs`, `sessions.rs` | recording and opening of sessions |
//! | `server.rs`, `socket.rs`, `actions.rs`, `body.rs`, `access.rs` | HTTP: the page, the feed, handlers of requests, their limits, access control |
//! | `running.rs` | a running monitor, for the user's other programs |
//! | `monitor_state.rs`, `app_state.rs` | state of the threads; state of the handlers |
//! | `plain.rs` | one line per second instead, for a terminal |
//! | `page/` | the page, embedded in the program |

mod access;
mod actions;
mod app_state;
mod body;
mod error;
mod feed;
mod history;
mod host_replica;
mod hub;
mod latency;
mod live;
mod monitor_state;
mod page_row;
mod plain;
mod recording;
mod running;
mod server;
mod sessions;
mod socket;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use calibration_tables::CompiledTable;
use estimator_core::Q;
use proprio_check::Finding;
use proprio_link::{Link, Subscription};
use proprio_server::{LocalServer, serve_connection};
use proprio_session::LoadedTable;
use telemetry::{Command, TICK_HZ};
use tokio::io::{AsyncRead, AsyncWrite};

pub use access::Token;
pub use error::Error;
pub use plain::Plain;
pub use running::{RunningMonitor, RunningMonitorError};

use app_state::AppState;
use feed::ArmDescription;
use hub::Hub;

use monitor_state::MonitorState;
use running::Announcement;
use sessions::Sessions;

/// Options of a monitor.
#[derive(Debug)]
pub struct Options<'p> {
    /// Port of 127.0.0.1; 0: any free one.
    pub port: u16,
    /// Table of the arm: without it there is neither drift nor innovation, and no session can be opened.
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
    _announcement: Option<Announcement>,
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
        let compiled = options.table.as_ref().map(|table| table.compile::<Q>(TICK_HZ)).transpose()?;
        let (link, events) = live.unzip();
        let announcement = announce(link.as_ref(), &options, address);
        let (announcement, program_token) = announcement.unzip();
        let shared = Arc::new(shared(link, options, program_token));
        if let Some(events) = events {
            let shared = Arc::clone(&shared);
            server.spawn("hub", move |stop| hub(&shared, events, compiled.as_ref(), stop)).map_err(failed)?;
        }
        let state = AppState { monitor: Arc::clone(&shared), port: address.port() };
        server.serve("server", |listener| server::serve(listener, server::router(state))).map_err(failed)?;
        Ok(Self { server, shared, _announcement: announcement })
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

/// Announces the monitor of a board to this user's programs, with a token for them. Without it they cannot use it, which is no
/// failure of the monitor.
fn announce(link: Option<&Link>, options: &Options, address: SocketAddr) -> Option<(Announcement, Token)> {
    let line = link?.state().port?;
    let token = Token::new().ok()?;
    let monitor = RunningMonitor { line, address, token: token.to_string(), stream: options.stream };
    Some((Announcement::new(options.runtime_folder.as_deref()?, &monitor).ok()?, token))
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
    let segments = table.map_or(0, |table| table.file.segments.len());
    let mut arm = ArmDescription::new(segments, table.map(|table| &table.file));
    (arm.is_live, arm.allows_control) = (link.is_some(), options.token.is_some());
    let sessions = Sessions::new(options.folder, table, options.session, options.finding_text);
    arm.session = sessions.given();
    MonitorState::new(link, arm, options.token, program_token, sessions, options.help)
}

fn hub(shared: &Arc<MonitorState>, events: Subscription, compiled: Option<&CompiledTable<Q>>, stop: &AtomicBool) {
    let table = compiled.map(CompiledTable::config);
    if let Some(link) = &shared.link {
        let check = shared.sessions.check();
        Hub::new(Arc::clone(shared), events, table.as_ref(), check).run(link, stop);
    }
}
