//! Payload of a frame: the topics of both directions and the messages' bodies.

use serde::{Deserialize, Serialize};

use crate::decode_error::DecodeError;
use crate::message::{Message, Request};

/// Numbers of the kinds of messages. A number is never reused for another kind.
pub mod topic {
    /// [`Hello`](crate::Hello), from the board.
    pub const HELLO: u8 = 1;
    /// [`Sample`](crate::Sample), from the board.
    pub const SAMPLE: u8 = 2;
    /// [`Estimate`](crate::Estimate), from the board.
    pub const ESTIMATE: u8 = 3;
    /// [`Health`](crate::Health), from the board.
    pub const HEALTH: u8 = 4;
    /// [`Event`](crate::Event), from the board.
    pub const EVENT: u8 = 5;
    /// [`Reply`](crate::Reply), from the board.
    pub const REPLY: u8 = 6;
    /// [`Uncertainty`](crate::Uncertainty), from the board.
    pub const UNCERTAINTY: u8 = 7;
    /// [`TableState`](crate::TableState), from the board.
    pub const TABLE: u8 = 8;
    /// [`TableChunk`](crate::TableChunk), from the board.
    pub const TABLE_DATA: u8 = 9;
    /// [`Request`](crate::Request), from the host.
    pub const REQUEST: u8 = 0x80;
}

/// Payload of one direction: the board's [`Message`], the host's [`Request`].
pub trait Payload: Sized {
    /// Number of the kind of message.
    fn topic(&self) -> u8;

    /// Writes the body and returns its length in bytes; `None` if it does not fit.
    fn write(&self, body: &mut [u8]) -> Option<usize>;

    /// Reads a whole body.
    ///
    /// # Errors
    /// [`DecodeError::Topic`], [`DecodeError::Body`] or [`DecodeError::Request`].
    fn read(topic: u8, body: &[u8]) -> Result<Self, DecodeError>;

    /// Number of the sender's boot, if the message contains it.
    fn boot(&self) -> Option<u32> {
        None
    }
}

impl Payload for Message {
    fn topic(&self) -> u8 {
        match self {
            Self::Hello(_) => topic::HELLO,
            Self::Sample(_) => topic::SAMPLE,
            Self::Estimate(_) => topic::ESTIMATE,
            Self::Health(_) => topic::HEALTH,
            Self::Event(_) => topic::EVENT,
            Self::Reply(_) => topic::REPLY,
            Self::Uncertainty(_) => topic::UNCERTAINTY,
            Self::Table(_) => topic::TABLE,
            Self::TableData(_) => topic::TABLE_DATA,
        }
    }

    fn write(&self, body: &mut [u8]) -> Option<usize> {
        match self {
            Self::Hello(hello) => write(hello, body),
            Self::Sample(sample) => write(sample, body),
            Self::Estimate(estimate) => write(estimate, body),
            Self::Health(health) => write(health, body),
            Self::Event(event) => write(event, body),
            Self::Reply(reply) => write(reply, body),
            Self::Uncertainty(uncertainty) => write(uncertainty, body),
            Self::Table(state) => write(state, body),
            Self::TableData(chunk) => write(chunk, body),
        }
    }

    fn read(topic: u8, body: &[u8]) -> Result<Self, DecodeError> {
        let message = match topic {
            topic::HELLO => read(body).map(Self::Hello),
            topic::SAMPLE => read(body).map(Self::Sample),
            topic::ESTIMATE => read(body).map(Self::Estimate),
            topic::HEALTH => read(body).map(Self::Health),
            topic::EVENT => read(body).map(Self::Event),
            topic::REPLY => read(body).map(Self::Reply),
            topic::UNCERTAINTY => read(body).map(Self::Uncertainty),
            topic::TABLE => read(body).map(Self::Table),
            topic::TABLE_DATA => read(body).map(Self::TableData),
            _ => return Err(DecodeError::Topic(topic)),
        };
        message.ok_or(DecodeError::Body(topic))
    }

    fn boot(&self) -> Option<u32> {
        match self {
            Self::Hello(hello) => Some(hello.boot),
            _ => None,
        }
    }
}

impl Payload for Request {
    fn topic(&self) -> u8 {
        topic::REQUEST
    }

    fn write(&self, body: &mut [u8]) -> Option<usize> {
        write(self, body)
    }

    fn read(topic: u8, body: &[u8]) -> Result<Self, DecodeError> {
        if topic != topic::REQUEST {
            return Err(DecodeError::Topic(topic));
        }
        read(body).ok_or_else(|| match postcard::take_from_bytes(body) {
            Ok((id, _)) => DecodeError::Request(id),
            Err(_) => DecodeError::Body(topic),
        })
    }
}

fn write<T: Serialize>(value: &T, body: &mut [u8]) -> Option<usize> {
    postcard::to_slice(value, body).ok().map(|used| used.len())
}

/// Reads a value that takes all of `body`.
fn read<'b, T: Deserialize<'b>>(body: &'b [u8]) -> Option<T> {
    postcard::take_from_bytes(body).ok().and_then(|(value, rest)| rest.is_empty().then_some(value))
}
