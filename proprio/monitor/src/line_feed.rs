//! The board's line for one program of this user, over a WebSocket: the bytes that the board sends, and its requests to the board.
//!
//! A program that reads slowly delays nobody: its events wait in a queue of their own, which drops the oldest, and the number of
//! those is sent to it. When its connection ends, none of its requests is sent any more, except what vents the arm.

use std::sync::mpsc::Receiver;
use std::sync::{Arc, Weak};
use std::time::Duration;

use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use proprio_link::{EventKind, Link, LinkError, LinkEvent, ReceivedBytes, RequestError, Subscription};
use serde::Deserialize;
use telemetry::Command;
use tokio::sync::mpsc::{Sender, channel};
use tokio::task::spawn_blocking;

use super::access::Refused;
use super::app_state::AppState;
use super::line_message::{LineMessage, LineRequest, push_bytes};
use super::programs::check_token;

/// Longest message of a program, bytes.
const LONGEST: usize = 4096;

/// Messages that wait for the socket; the events behind them wait in the link's queue.
const WAITING: usize = 16;

/// Longest time between two checks for the end of the connection.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// Bytes of the history in one message.
const HISTORY_MESSAGE: usize = 1 << 16;

#[derive(Debug, Deserialize)]
pub(super) struct LineQuery {
    /// Send the bytes since the last start of the board's estimator first.
    #[serde(default)]
    history: bool,
}

/// Opens the line to a program.
pub(super) async fn line(
    State(state): State<AppState>,
    headers: HeaderMap,
    Query(query): Query<LineQuery>,
    upgrade: WebSocketUpgrade,
) -> Response {
    if let Err(refused) = check_token(&state, &headers) {
        return Refused::into_response(refused);
    }
    let Some(link) = state.monitor.link.as_ref().map(Link::second_handle) else {
        return (StatusCode::NOT_FOUND, "there is no board").into_response();
    };
    upgrade.max_message_size(LONGEST).on_upgrade(move |socket| async move {
        // A program that leaves ends its connection.
        let _ = serve(link, query.history, socket).await;
    })
}

async fn serve(link: Link, with_history: bool, mut socket: WebSocket) -> Result<(), axum::Error> {
    let (messages, mut waiting) = channel(WAITING);
    let (requests, received) = std::sync::mpsc::channel();
    let program = Arc::new(());
    let (asker, answers) = (Arc::downgrade(&program), messages.clone());
    // The program's begin precedes all answers.
    let feed = LineFeed::begin(&link, with_history);
    spawn_blocking(move || feed.run(&messages));
    spawn_blocking(move || execute(&link, &asker, &received, &answers));
    loop {
        tokio::select! {
            Some(message) = waiting.recv() => socket.send(message).await?,
            request = socket.recv() => {
                let Some(request) = request.transpose()? else { return Ok(()) };
                let Message::Text(request) = request else { continue };
                // Of a program of another version; it sees the end of its connection.
                let Ok(request) = serde_json::from_str(&request) else { return Ok(()) };
                let _ = requests.send(request);
            }
        }
    }
}

/// Sends the program's requests to the board, one after the other.
fn execute(link: &Link, program: &Weak<()>, requests: &Receiver<LineRequest>, messages: &Sender<Message>) {
    while let Ok(LineRequest { id, command }) = requests.recv() {
        let kept = (command == Command::Disarm).then(|| Arc::new(()));
        let asker = kept.as_ref().map_or_else(|| program.clone(), Arc::downgrade);
        let error = link.request_of(&asker, command).err().map(|error| match error {
            LinkError::Request(error) => error,
            _ => RequestError::Interrupted,
        });
        // The program may have left.
        let _ = messages.blocking_send(text(&LineMessage::Answer { id, error }));
    }
}

/// The events of the link for one program.
struct LineFeed {
    line: Option<String>,
    events: Subscription,
    history: Option<Vec<ReceivedBytes>>,
    /// The first bytes may be the rest of a frame, which is left out.
    is_in_frame: bool,
    /// Events that were dropped, and that the program knows of.
    dropped: u64,
}

/// The program has left.
struct Left;

impl LineFeed {
    fn begin(link: &Link, with_history: bool) -> Self {
        let line = link.state().port;
        let (events, history) = if with_history { link.subscribe_with_history() } else { (link.subscribe(), None) };
        Self { line, events, is_in_frame: history.is_none(), history, dropped: 0 }
    }

    /// Sends until the program has left, or the line is gone for good.
    fn run(mut self, messages: &Sender<Message>) {
        // Nobody waits for a program that has left.
        let _ = self.send_begin(messages).and_then(|()| self.send_events(messages));
    }

    fn send_begin(&mut self, messages: &Sender<Message>) -> Result<(), Left> {
        let send = |message| messages.blocking_send(message).map_err(|_| Left);
        let (line, history) = (self.line.take(), self.history.take());
        send(text(&LineMessage::Begin { line, has_history: history.is_some() }))?;
        let mut part = Vec::new();
        for received in history.unwrap_or_default() {
            push_bytes(&mut part, &received);
            if part.len() >= HISTORY_MESSAGE {
                send(Message::Binary(std::mem::take(&mut part).into()))?;
            }
        }
        if !part.is_empty() {
            send(Message::Binary(part.into()))?;
        }
        send(text(&LineMessage::Live))
    }

    fn send_events(&mut self, messages: &Sender<Message>) -> Result<(), Left> {
        while !messages.is_closed() {
            let Some(event) = self.events.next(CHECK_PERIOD) else { continue };
            let is_end = matches!(event.kind, EventKind::Ended(_));
            let dropped = self.events.dropped();
            if dropped != self.dropped {
                let more = text(&LineMessage::Dropped(dropped - self.dropped));
                messages.blocking_send(more).map_err(|_| Left)?;
                self.dropped = dropped;
            }
            if let Some(message) = self.message(event) {
                messages.blocking_send(message).map_err(|_| Left)?;
            }
            if is_end {
                break;
            }
        }
        Ok(())
    }

    /// The message of an event; the program decodes the bytes itself.
    fn message(&mut self, LinkEvent { at, kind, .. }: LinkEvent) -> Option<Message> {
        Some(match kind {
            EventKind::Bytes(bytes) => {
                let bytes = self.behind_frame_rest(bytes)?;
                let mut message = Vec::new();
                push_bytes(&mut message, &(at, bytes));
                Message::Binary(message.into())
            }
            EventKind::Opened(name) => {
                self.is_in_frame = false;
                text(&LineMessage::Opened(name))
            }
            EventKind::Lost(reason) => text(&LineMessage::Lost(reason)),
            EventKind::Ended(reason) => text(&LineMessage::Ended(reason)),
            EventKind::SetPoints(requested) => text(&LineMessage::SetPoints { at_ns: at.0, requested }),
            EventKind::Message(_) | EventKind::Undecoded(_) | EventKind::Restarted | EventKind::Mismatch(_) => {
                return None;
            }
        })
    }

    /// The bytes without the rest of a frame whose begin the program does not have; `None` where nothing is left.
    fn behind_frame_rest(&mut self, bytes: Arc<[u8]>) -> Option<Arc<[u8]>> {
        if !self.is_in_frame {
            return Some(bytes);
        }
        let end = bytes.iter().position(|byte| *byte == 0)?;
        self.is_in_frame = false;
        Some(Arc::from(&bytes[end + 1..])).filter(|rest: &Arc<[u8]>| !rest.is_empty())
    }
}

fn text(message: &LineMessage) -> Message {
    Message::Text(serde_json::to_string(message).expect("numbers and texts have a form in JSON").into())
}
