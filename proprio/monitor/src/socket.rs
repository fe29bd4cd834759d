//! The feed to one page, over a WebSocket.

use axum::extract::State;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use serde::Deserialize;
use tokio::sync::broadcast::error::RecvError;

use super::feed::Feed;
use super::server::Server;

/// Longest message of a page, bytes.
const LONGEST: usize = 4096;

/// What a page says.
#[derive(Debug, Deserialize)]
struct Shown {
    /// [`newest_us`](super::feed::Batch::newest_us) of the batch that is on its screen.
    shown_us: u64,
}

pub(super) async fn feed(State(server): State<Server>, upgrade: WebSocketUpgrade) -> Response {
    upgrade.max_message_size(LONGEST).on_upgrade(|socket| async move {
        // A page that leaves ends its feed.
        let _ = serve(server, socket).await;
    })
}

async fn serve(Server { shared, .. }: Server, mut socket: WebSocket) -> Result<(), axum::Error> {
    let mut feed = shared.feed.subscribe();
    socket.send(text(&Feed::Arm(&shared.arm))).await?;
    loop {
        tokio::select! {
            message = feed.recv() => match message {
                Ok(json) => socket.send(Message::Text(json)).await?,
                Err(RecvError::Lagged(messages)) => socket.send(text(&Feed::Skipped { messages })).await?,
                Err(RecvError::Closed) => return Ok(()),
            },
            said = socket.recv() => {
                let Some(said) = said.transpose()? else { return Ok(()) };
                if let Message::Text(said) = said
                    && let Ok(Shown { shown_us }) = serde_json::from_str(&said)
                {
                    let now_us = shared.clock.now().0 / 1000;
                    shared.latency().push(now_us.saturating_sub(shown_us));
                }
            }
        }
    }
}

fn text(message: &Feed) -> Message {
    Message::Text(Utf8Bytes::from(message.json()))
}
