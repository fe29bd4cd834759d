//! The feed to one page, over a WebSocket.

use axum::extract::State;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use serde::Deserialize;
use tokio::sync::broadcast::error::RecvError;

use super::app_state::AppState;
use super::feed::Feed;

/// Longest message of a page, bytes.
const LONGEST: usize = 4096;

/// Report of a page.
#[derive(Debug, Deserialize)]
struct Shown {
    /// [`newest_us`](super::feed::Batch::newest_us) of the batch on its screen.
    shown_us: u64,
}

/// Opens the feed to a page.
pub(super) async fn feed(State(state): State<AppState>, upgrade: WebSocketUpgrade) -> Response {
    upgrade.max_message_size(LONGEST).on_upgrade(|socket| async move {
        // A page that leaves ends its feed.
        let _ = serve(state, socket).await;
    })
}

async fn serve(AppState { monitor, .. }: AppState, mut socket: WebSocket) -> Result<(), axum::Error> {
    let mut feed = monitor.feed.subscribe();
    let arm = text(&Feed::Arm(&monitor.arm()));
    socket.send(arm).await?;
    loop {
        tokio::select! {
            message = feed.recv() => match message {
                Ok(json) => socket.send(Message::Text(json)).await?,
                Err(RecvError::Lagged(messages)) => socket.send(text(&Feed::Skipped { messages })).await?,
                Err(RecvError::Closed) => return Ok(()),
            },
            report = socket.recv() => {
                let Some(report) = report.transpose()? else { return Ok(()) };
                if let Message::Text(report) = report
                    && let Ok(Shown { shown_us }) = serde_json::from_str(&report)
                {
                    let now_us = monitor.clock.now().0 / 1000;
                    monitor.latency().push(now_us.saturating_sub(shown_us));
                }
            }
        }
    }
}

fn text(message: &Feed) -> Message {
    Message::Text(Utf8Bytes::from(message.json()))
}
