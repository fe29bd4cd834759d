//! A live stream of a board over the WebSocket protocol of [Foxglove](https://docs.foxglove.dev), for Foxglove, Lichtblick and
//! PlotJuggler.
//!
//! A thread takes the link's events, makes the messages of a [recording](proprio_session::recording)'s channels of them, and of
//! two channels more for 3D panels, and passes them to the clients that have subscribed. A channel without a subscriber is not
//! encoded. Each client has a bounded queue, which drops its oldest messages: a slow client delays neither the board nor
//! another client. No client can send anything to the board.
//!
//! | file | purpose |
//! |---|---|
//! | `feed.rs` | the link's events as messages, for all clients |
//! | `channels.rs` | the channels and their numbers |
//! | `scene.rs`, `arm_line.rs`, `scene_schemas.rs` | transforms and markers of the arm; the line from its base to its tip; their schemas |
//! | `stream.rs` | state of thread and clients: the queue, and who receives which channel |
//! | `server.rs`, `client.rs` | HTTP, and the session of one client |
//! | `protocol.rs` | messages of the protocol |
//! | `access.rs` | origins that are answered |

mod access;
mod arm_line;
mod channels;
mod client;
mod error;
mod feed;
mod protocol;
mod scene;
mod scene_schemas;
mod server;
mod stream;

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use calibration_tables::ArmFile;
use proprio_link::Subscription;

pub use error::Error;

use feed::Feed;
use stream::Stream;

/// A server that runs until it is dropped.
#[derive(Debug)]
pub struct FoxgloveServer {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    stop_server: Option<tokio::sync::oneshot::Sender<()>>,
    threads: Vec<JoinHandle<()>>,
}

impl FoxgloveServer {
    /// Starts to serve the events of a link on this port of 127.0.0.1; 0: any free one. `table` has the geometry of the arm;
    /// without it connectors are drawn as parts of the arcs.
    ///
    /// # Errors
    /// [`Error::Listen`].
    pub fn start(events: Subscription, port: u16, table: Option<&ArmFile>) -> Result<Self, Error> {
        let failed = |source| Error::Listen { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let stream = Arc::new(Stream::new());
        let (stop_server, stopped) = tokio::sync::oneshot::channel();
        let stop = Arc::new(AtomicBool::new(false));
        let mut server = Self { address, stop, stop_server: Some(stop_server), threads: Vec::new() };

        let (feed, stop) = (Feed::new(Arc::clone(&stream), table), Arc::clone(&server.stop));
        server.spawn("foxglove feed", move || feed.run(&events, &stop)).map_err(failed)?;

        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(failed)?;
        let work = async move {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            tokio::select! {
                served = server::serve(listener, stream) => served,
                _ = stopped => Ok(()),
            }
        };
        let serve = move || {
            // A server error cannot be reported at this point.
            let _ = runtime.block_on(work);
            // Do not wait for a client that does not read.
            runtime.shutdown_background();
        };
        server.spawn("foxglove", serve).map_err(failed)?;
        Ok(server)
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
        self.threads.push(std::thread::Builder::new().name(name.to_owned()).spawn(work)?);
        Ok(())
    }

    /// Its address.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for FoxgloveServer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(stop) = self.stop_server.take() {
            // The server may have ended already.
            let _ = stop.send(());
        }
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}
