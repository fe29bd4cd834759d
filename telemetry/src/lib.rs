//! The serial protocol between the arm's board and a host.
//!
//! The board sends [`Message`]s, the host sends [`Request`]s. Either way an [`Encoder`] makes a frame of each, and a
//! [`Decoder`] finds frames in a stream of bytes, checks them and counts the missing ones. The crate is `no_std`,
//! allocates nothing and does no input or output. `docs/reference/protocol.md` in the repository has every byte.
//!
//! | file | contents |
//! |---|---|
//! | `bounded.rs` | texts and vectors of limited length |
//! | `constants.rs` | [`PROTOCOL_VERSION`], [`MAX_FRAME`], the largest arm's numbers |
//! | `message.rs`, `request.rs`, `table_message.rs`, `conditions.rs` | messages, requests and replies |
//! | `wire.rs`, `wire_conversions.rs` | fixed-width forms of the messages of every tick |
//! | `topic.rs`, `payload.rs`, `body.rs` | topics and bodies |
//! | `protocol_2.rs` | the version before, which a host still reads |
//! | `frame.rs` | COBS, CRC and [`Encoder`] |
//! | `decoder.rs`, `decode_error.rs` | [`Decoder`] and its errors |
//! | `line.rs` | lengths of an arm's frames, and the rates at which they fit the line |
//! | `schema.rs` | [`SCHEMA`], the hash of the messages' layout |
//! | `estimator.rs` | a [`Sample`] for `estimator-core`, and an [`Estimate`], [`Uncertainty`] and contact from it |
//!
//! ```
//! use telemetry::{Command, DecodeError, Decoder, Encoder, MAX_FRAME, Message, RequestOutcome, Refusal, Reply, Request};
//!
//! // The host sends a request.
//! let mut host = Encoder::new();
//! let mut buffer = [0; MAX_FRAME];
//! let request = Request { id: 1, session: 0, command: Command::Arm };
//! let frame = host.encode(&request, &mut buffer)?;
//!
//! // The board decodes the received bytes one by one and replies.
//! let mut requests = Decoder::<Request>::new();
//! let received = frame.iter().find_map(|&byte| requests.push(byte));
//! assert_eq!(received, Some(Ok(request.clone())));
//! let mut board = Encoder::new();
//! let refused = Reply { id: request.id, session: 0, outcome: RequestOutcome::Nack(Refusal::Busy) };
//! let reply = Message::Reply(refused);
//! let mut line = board.encode(&reply, &mut buffer)?.to_vec();
//!
//! // Noise damages the frame that it hits, and no other.
//! let mut damaged = line.clone();
//! damaged[5] ^= 0x10;
//! line.splice(0..0, damaged);
//! let mut messages = Decoder::<Message>::new();
//! let decoded: Vec<_> = line.into_iter().filter_map(|byte| messages.push(byte)).collect();
//! assert_eq!(decoded, [Err(DecodeError::Damaged), Ok(reply)]);
//! assert_eq!(messages.counts().damaged, 1);
//! # Ok::<(), telemetry::EncodeError>(())
//! ```
#![no_std]

mod body;
mod bounded;
mod conditions;
mod constants;
mod decode_error;
mod decoder;
mod estimator;
mod frame;
mod line;
mod message;
mod payload;
pub mod protocol_2;
mod request;
mod schema;
mod table_message;
pub mod topic;
mod wire;
mod wire_conversions;

pub use bounded::{Text, text, vector};
pub use conditions::Conditions;
pub use constants::{
    BEND_PER_SEGMENT, MAX_BEND_SENSORS, MAX_FRAME, MAX_REGULATORS, MAX_SEGMENTS, PROTOCOL_VERSION, TABLE_CHUNK_BYTES,
    TICK_HZ, TICK_US,
};
pub use decode_error::DecodeError;
pub use decoder::{Counts, Decoder};
pub use frame::{EncodeError, Encoder};
pub use line::{FrameLengths, HELLO_TICKS, LINE_BYTES_PER_SECOND, STREAM_BYTES_PER_SECOND};
pub use message::*;
pub use payload::Payload;
pub use request::*;
pub use schema::{EARLIER_SCHEMAS, SCHEMA, is_same_layout};
pub use table_message::{TableAnnouncement, TableChunk, TableState, TableStatus};

/// Runs the example of the protocol's page.
#[cfg(doctest)]
#[doc = include_str!("../../docs/reference/protocol.md")]
struct ProtocolPage;
