//! HTTP: the handshake of a client.

use std::io;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::State;
use axum::extract::ws::{WebSocketUpgrade, rejection::WebSocketUpgradeRejection};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use proprio_server::serve_connection;
use tokio::net::TcpListener;

use crate::access;
use crate::client;
use crate::protocol::SUBPROTOCOLS;
use crate::stream::Stream;

/// Longest time for the head of a request.
const HEAD_TIMEOUT: Duration = Duration::from_secs(10);

/// Longest message of a client, bytes.
const LONGEST: usize = 65_536;

/// Serves connections until the listener fails.
pub async fn serve(listener: TcpListener, stream: Arc<Stream>) -> io::Result<()> {
    let router = Router::new().fallback(connect).with_state(stream);
    loop {
        let (tcp, _) = listener.accept().await?;
        // Small messages are sent at once, where the system can do that.
        let _ = tcp.set_nodelay(true);
        tokio::spawn(serve_connection(tcp, router.clone(), HEAD_TIMEOUT));
    }
}

/// Answers a request: a client of the protocol gets the stream.
async fn connect(
    State(stream): State<Arc<Stream>>,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response {
    if let Err(refused) = access::check(&headers) {
        return (StatusCode::FORBIDDEN, refused.to_string()).into_response();
    }
    let Ok(upgrade) = upgrade else {
        let text = "this is a WebSocket of proprio: open its address, with ws:// in front, in Foxglove, Lichtblick or PlotJuggler";
        return (StatusCode::UPGRADE_REQUIRED, text).into_response();
    };
    let upgrade = upgrade.max_message_size(LONGEST).protocols(SUBPROTOCOLS);
    if upgrade.selected_protocol().is_none() {
        let text = format!("this server speaks {} and {}", SUBPROTOCOLS[0], SUBPROTOCOLS[1]);
        return (StatusCode::BAD_REQUEST, text).into_response();
    }
    upgrade.on_upgrade(|socket| async move {
        // A client that leaves ends its session.
        let _ = client::serve(&stream, socket).await;
    })
}
