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
//! | `live_messages.rs` | the link's events as messages |
//! | `feed.rs` | the messages, for all clients |
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
mod live_messages;
mod protocol;
mod scene;
mod scene_schemas;
mod server;
mod stream;

use std::net::SocketAddr;
use std::sync::Arc;

use calibration_tables::ArmFile;
use proprio_link::Subscription;
use proprio_server::LocalServer;

pub use channels::all as channels;
pub use error::Error;
pub use live_messages::LiveMessages;

use feed::Feed;
use stream::Stream;

/// A server that runs until it is dropped.
#[derive(Debug)]
pub struct FoxgloveServer(LocalServer);

impl FoxgloveServer {
    /// Starts to serve the events of a link on this port of 127.0.0.1; 0: any free one. `table` has the geometry of the arm;
    /// without it connectors are drawn as parts of the arcs.
    ///
    /// # Errors
    /// [`Error::Listen`].
    pub fn start(events: Subscription, port: u16, table: Option<&ArmFile>) -> Result<Self, Error> {
        let failed = |source| Error::Listen { port, source };
        let mut server = LocalServer::bind(port).map_err(failed)?;
        let stream = Arc::new(Stream::new());
        let feed = Feed::new(Arc::clone(&stream), table);
        server.spawn("foxglove feed", move |stop| feed.run(&events, stop)).map_err(failed)?;
        server.serve("foxglove", |listener| server::serve(listener, stream)).map_err(failed)?;
        Ok(Self(server))
    }

    /// Its address.
    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.0.address()
    }
}
