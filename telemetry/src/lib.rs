//! The serial protocol between the arm's board and a host.
//!
//! The board sends [`Message`]s, the host sends [`Request`]s. Either way an [`Encoder`] makes a frame of one, and a
//! [`Decoder`] finds frames in whatever bytes arrive, checks them and counts what is missing. The crate is `no_std`,
//! allocates nothing and does no input or output itself. `docs/reference/protocol.md` in the repository has every byte.
//!
//! | file | what it is for |
//! |---|---|
//! | `message.rs` | what board and host say to each other |
//! | `wire.rs` | compact forms of what is sent every tick |
//! | `payload.rs` | topics and bodies |
//! | `frame.rs` | COBS, CRC and [`Encoder`] |
//! | `decoder.rs` | [`Decoder`] |
//! | `schema.rs` | [`SCHEMA`], the hash of the messages' layout |
//! | `estimator.rs` | a [`Sample`] for `estimator-core`, and an [`Estimate`], [`Uncertainty`] and contact from it |
//!
//! ```
//! use telemetry::{Command, DecodeError, Decoder, Encoder, MAX_FRAME, Message, Outcome, Refusal, Reply, Request};
//!
//! // The host asks.
//! let mut host = Encoder::new();
//! let mut buffer = [0; MAX_FRAME];
//! let request = Request { id: 1, command: Command::Arm };
//! let frame = host.encode(&request, &mut buffer)?;
//!
//! // The board takes byte for byte what arrives, in interrupts or from a buffer, and answers.
//! let mut requests = Decoder::<Request>::new();
//! let received = frame.iter().find_map(|&byte| requests.push(byte));
//! assert_eq!(received, Some(Ok(request)));
//! let mut board = Encoder::new();
//! let reply = Message::Reply(Reply { id: request.id, outcome: Outcome::Nack(Refusal::Busy) });
//! let mut line = board.encode(&reply, &mut buffer)?.to_vec();
//!
//! // Noise costs the frame that it hits, and no other.
//! let mut damaged = line.clone();
//! damaged[5] ^= 0x10;
//! line.splice(0..0, damaged);
//! let mut messages = Decoder::<Message>::new();
//! let heard: Vec<_> = line.into_iter().filter_map(|byte| messages.push(byte)).collect();
//! assert_eq!(heard, [Err(DecodeError::Damaged), Ok(reply)]);
//! assert_eq!(messages.counts().damaged, 1);
//! # Ok::<(), telemetry::EncodeError>(())
//! ```
#![no_std]

mod decoder;
mod estimator;
mod frame;
mod message;
mod payload;
mod schema;
mod wire;

pub use decoder::{Counts, DecodeError, Decoder};
pub use estimator::touched;
pub use frame::{EncodeError, Encoder, MAX_FRAME, PROTOCOL_VERSION};
pub use message::*;
pub use payload::{Payload, topic};
pub use schema::{EARLIER_SCHEMAS, SCHEMA, is_same_layout};

/// The page's example is true.
#[cfg(doctest)]
#[doc = include_str!("../../docs/reference/protocol.md")]
struct ProtocolPage;
