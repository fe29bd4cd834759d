//! The session of one client: its subscriptions, and the messages on their channels.

use std::time::{Duration, Instant};

use axum::extract::ws::{Message, WebSocket};
use futures_util::SinkExt;
use tokio::sync::broadcast::error::RecvError;

use crate::channels;
use crate::protocol::{ClientMessage, ServerMessage, Subscribe, message_data};
use crate::stream::{Stream, StreamMessage};

/// Shortest time between two warnings that messages were lost.
const WARNING_PERIOD: Duration = Duration::from_secs(5);

/// Serves a client until it leaves.
pub async fn serve(stream: &Stream, mut socket: WebSocket) -> Result<(), axum::Error> {
    let mut batches = stream.batches();
    let mut subscriptions = Subscriptions { stream, of_channels: [None; channels::COUNT] };
    let mut warned = None::<Instant>;
    socket.send(text(&ServerMessage::server_info(&stream.session_id))).await?;
    socket.send(text(&ServerMessage::advertise())).await?;
    loop {
        tokio::select! {
            batch = batches.recv() => match batch {
                Ok(batch) => send_batch(&mut socket, &subscriptions, &batch).await?,
                Err(RecvError::Lagged(_)) => if warned.is_none_or(|warned| warned.elapsed() >= WARNING_PERIOD) {
                    warned = Some(Instant::now());
                    let warning = "this client is too slow, and has lost the oldest messages of the board";
                    socket.send(text(&ServerMessage::warning("lost", warning))).await?;
                },
                Err(RecvError::Closed) => return Ok(()),
            },
            request = socket.recv() => {
                let Some(request) = request.transpose()? else { return Ok(()) };
                if let Message::Text(request) = request
                    && let Some(warning) = subscriptions.take(&request)
                {
                    socket.send(text(&ServerMessage::warning("request", warning))).await?;
                }
            }
        }
    }
}

/// Sends the messages that the client has subscribed to, in one write.
async fn send_batch(
    socket: &mut WebSocket,
    subscriptions: &Subscriptions<'_>,
    batch: &[StreamMessage],
) -> Result<(), axum::Error> {
    for StreamMessage { channel, at, data } in batch {
        if let Some(id) = subscriptions.of_channels[*channel] {
            socket.feed(Message::Binary(message_data(id, at.0, data))).await?;
        }
    }
    socket.flush().await
}

/// The subscriptions of a client.
struct Subscriptions<'s> {
    stream: &'s Stream,
    /// The client's number of its subscription to each channel.
    of_channels: [Option<u32>; channels::COUNT],
}

impl Subscriptions<'_> {
    /// Takes a request; returns a warning where it cannot be done.
    fn take(&mut self, request: &str) -> Option<String> {
        match serde_json::from_str(request) {
            Ok(ClientMessage::Subscribe { subscriptions }) => {
                subscriptions.into_iter().filter_map(|subscription| self.add(subscription)).last()
            }
            Ok(ClientMessage::Unsubscribe { subscription_ids }) => {
                for id in subscription_ids {
                    self.remove(id);
                }
                None
            }
            Ok(ClientMessage::Other) => None,
            Err(error) => Some(format!("the request is not of this protocol: {error}")),
        }
    }

    fn add(&mut self, Subscribe { id, channel_id }: Subscribe) -> Option<String> {
        match self.of_channels.get_mut(channel_id) {
            None => Some(format!("there is no channel {channel_id}")),
            Some(Some(_)) => Some(format!("channel {channel_id} is subscribed to already")),
            Some(free) => {
                *free = Some(id);
                self.stream.subscribed(channel_id);
                None
            }
        }
    }

    fn remove(&mut self, id: u32) {
        for (channel, subscription) in self.of_channels.iter_mut().enumerate() {
            if *subscription == Some(id) {
                *subscription = None;
                self.stream.unsubscribed(channel);
            }
        }
    }
}

impl Drop for Subscriptions<'_> {
    fn drop(&mut self) {
        for (channel, subscription) in self.of_channels.iter().enumerate() {
            if subscription.is_some() {
                self.stream.unsubscribed(channel);
            }
        }
    }
}

fn text(message: &ServerMessage) -> Message {
    Message::Text(message.json().into())
}
