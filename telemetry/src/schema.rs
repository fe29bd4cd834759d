//! A number that tells whether two programs mean the same messages.

use postcard_schema::key::Key;

use crate::message::{Message, Request};

/// Hash of the form of all messages: the names, order and types of their fields and variants, as they are on the line.
///
/// It is in every [`Hello`](crate::Hello), so that a host can tell a firmware of another release before it misreads it.
pub const SCHEMA: u32 = {
    let [a, b, c, d, e, f, g, h] = Key::for_path::<(Message, Request)>("telemetry").to_bytes();
    u32::from_le_bytes([a, b, c, d]) ^ u32::from_le_bytes([e, f, g, h])
};
