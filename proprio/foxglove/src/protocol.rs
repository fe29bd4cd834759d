//! Messages of [the protocol](https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md): those that a stream of a board
//! needs.

use std::fmt;

use axum::body::Bytes;
use proprio_session::recording::{CDR, Channel, ROS2_MESSAGE};
use serde::{Deserialize, Serialize};

use crate::channels;

/// Names of the protocol, the newer first; they differ in nothing but the name.
pub const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];

/// Opcode of a message on a channel.
const MESSAGE_DATA: u8 = 1;

/// Level of a warning.
const WARNING: u8 = 1;

/// A message to a client, as JSON.
#[derive(Debug, Serialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub enum ServerMessage<'m> {
    /// The first message.
    #[serde(rename_all = "camelCase")]
    ServerInfo {
        name: String,
        /// None: clients can subscribe, and nothing else.
        capabilities: [&'static str; 0],
        /// Another one after a restart of this program.
        session_id: &'m str,
    },
    /// The channels.
    Advertise { channels: Vec<ChannelInfo> },
    /// A warning that the client shows; one with the same id replaces it.
    Status { level: u8, message: String, id: &'static str },
}

/// A channel.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ChannelInfo {
    id: usize,
    topic: &'static str,
    encoding: &'static str,
    schema_name: &'static str,
    schema: String,
    schema_encoding: &'static str,
}

impl<'m> ServerMessage<'m> {
    pub fn server_info(session_id: &'m str) -> Self {
        Self::ServerInfo { name: format!("proprio {}", env!("CARGO_PKG_VERSION")), capabilities: [], session_id }
    }

    /// All channels.
    pub fn advertise() -> Self {
        let channels = channels::all().enumerate().map(|(id, Channel { topic, schema })| {
            let (schema_name, schema, schema_encoding) = (schema.name, schema.text(), ROS2_MESSAGE);
            ChannelInfo { id, topic, encoding: CDR, schema_name, schema, schema_encoding }
        });
        Self::Advertise { channels: channels.collect() }
    }

    pub fn warning(id: &'static str, message: impl fmt::Display) -> Self {
        Self::Status { level: WARNING, message: message.to_string(), id }
    }

    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("numbers and texts have a form in JSON")
    }
}

/// A message from a client, as JSON.
#[derive(Debug, PartialEq, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub enum ClientMessage {
    Subscribe {
        subscriptions: Vec<Subscribe>,
    },
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        subscription_ids: Vec<u32>,
    },
    /// What needs a capability that this server does not have.
    #[serde(other)]
    Other,
}

/// A subscription to a channel.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Subscribe {
    /// The client's number of the subscription.
    pub id: u32,
    /// Number of the channel.
    pub channel_id: usize,
}

/// The binary message of a subscription.
pub fn message_data(subscription: u32, log_time_ns: u64, data: &[u8]) -> Bytes {
    [&[MESSAGE_DATA][..], &subscription.to_le_bytes(), &log_time_ns.to_le_bytes(), data].concat().into()
}
