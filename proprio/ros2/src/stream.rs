//! The messages of a stream: the client's side of Foxglove's WebSocket protocol.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Duration;

use proprio::{ShutdownGuard, warn};
use proprio_foxglove::channels;
use proprio_session::recording::Channel;
use serde::Deserialize;
use serde_json::json;
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::http::header::SEC_WEBSOCKET_PROTOCOL;
use tungstenite::{Message, WebSocket};

use crate::error::Error;
use crate::node::Node;

/// Name of the protocol.
const SUBPROTOCOL: HeaderValue = HeaderValue::from_static("foxglove.sdk.v1");
/// Opcode of a message on a channel.
const MESSAGE_DATA: u8 = 1;
/// Longest wait for the server's first answer.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);
/// Longest time between two checks for Ctrl-C.
const CHECK_PERIOD: Duration = Duration::from_millis(50);

/// A message of the server, as JSON.
#[derive(Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
enum ServerMessage {
    /// The channels.
    Advertise { channels: Vec<Advertised> },
    /// A warning.
    Status { message: String },
    #[serde(other)]
    Other,
}

/// A channel of the server.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Advertised {
    id: u32,
    topic: String,
    schema_name: String,
}

/// Publishes the messages of the stream at `address` until Ctrl-C, or until its end.
pub fn publish(address: &str, node: &mut Node, shutdown: &ShutdownGuard) -> Result<(), Error> {
    let failed = |reason: String| Error::Stream { address: address.to_owned(), reason };
    let mut stream = Stream::open(address).map_err(failed)?;
    while !shutdown.is_requested() {
        if let Some((channel, message)) = stream.next().map_err(failed)? {
            node.publish(channel, message)?;
        }
    }
    Ok(())
}

/// True where a read has ended without data: at the end of its time, or by Ctrl-C.
fn is_pause(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

/// An open stream.
struct Stream {
    socket: WebSocket<TcpStream>,
    /// The channels that are subscribed to, in the order of the subscriptions' numbers.
    subscribed: Vec<&'static Channel>,
}

impl Stream {
    fn open(address: &str) -> Result<Self, String> {
        let mut request = format!("ws://{address}/").into_client_request().map_err(|error| error.to_string())?;
        request.headers_mut().insert(SEC_WEBSOCKET_PROTOCOL, SUBPROTOCOL);
        let tcp = TcpStream::connect(address).map_err(|error| error.to_string())?;
        tcp.set_read_timeout(Some(ANSWER_TIMEOUT)).map_err(|error| error.to_string())?;
        let (socket, _) = tungstenite::client(request, tcp).map_err(|error| error.to_string())?;
        socket.get_ref().set_read_timeout(Some(CHECK_PERIOD)).map_err(|error| error.to_string())?;
        Ok(Self { socket, subscribed: Vec::new() })
    }

    /// The next message on a channel; `None` where none comes in time.
    fn next(&mut self) -> Result<Option<(&'static Channel, Vec<u8>)>, String> {
        match self.socket.read() {
            Ok(Message::Binary(data)) => Ok(self.message(&data)),
            Ok(Message::Text(text)) => self.take(&text).map(|()| None),
            Ok(Message::Close(_)) => Err("the stream has ended".to_owned()),
            Ok(_) => Ok(None),
            Err(tungstenite::Error::Io(error)) if is_pause(error.kind()) => Ok(None),
            Err(error) => Err(format!("the stream has ended: {error}")),
        }
    }

    /// Takes a message about the stream.
    fn take(&mut self, text: &str) -> Result<(), String> {
        match serde_json::from_str(text) {
            Ok(ServerMessage::Advertise { channels }) => self.subscribe(&channels),
            Ok(ServerMessage::Status { message }) => {
                warn(&message);
                Ok(())
            }
            Ok(ServerMessage::Other) => Ok(()),
            Err(error) => Err(format!("this is no stream of proprio: {error}")),
        }
    }

    /// Subscribes to the channels that the node has.
    fn subscribe(&mut self, advertised: &[Advertised]) -> Result<(), String> {
        let mut subscriptions = Vec::new();
        for Advertised { id, topic, schema_name } in advertised {
            let same = |channel: &&Channel| channel.topic == topic && channel.schema.name == schema_name;
            if let Some(channel) = channels().find(same) {
                subscriptions.push(json!({"id": self.subscribed.len(), "channelId": id}));
                self.subscribed.push(channel);
            }
        }
        let request = json!({"op": "subscribe", "subscriptions": subscriptions});
        self.socket.send(Message::text(request.to_string())).map_err(|error| error.to_string())
    }

    /// The channel of a message, and the message without its head: opcode, number of the subscription, log time.
    fn message(&self, data: &[u8]) -> Option<(&'static Channel, Vec<u8>)> {
        let (&[MESSAGE_DATA, a, b, c, d], rest) = data.split_first_chunk()? else { return None };
        let (_log_time, message) = rest.split_at_checked(size_of::<u64>())?;
        let channel = self.subscribed.get(u32::from_le_bytes([a, b, c, d]) as usize)?;
        Some((channel, message.to_vec()))
    }
}
