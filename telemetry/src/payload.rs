//! Payload of a frame: topic and body of the messages of both directions.

use crate::body::{read, write};
use crate::constants::PROTOCOL_VERSION;
use crate::decode_error::DecodeError;
use crate::message::Message;
use crate::protocol_2;
use crate::request::Request;
use crate::topic;

/// Payload of one direction: the board's [`Message`], the host's [`Request`].
pub trait Payload: Sized {
    /// Versions of the protocol that can be read.
    const VERSIONS: &'static [u8];

    /// Number of the kind of message.
    fn topic(&self) -> u8;

    /// Writes the body in the layout of a version and returns its length in bytes; `None` if it does not fit.
    fn write(&self, version: u8, body: &mut [u8]) -> Option<usize>;

    /// Reads a whole body in the layout of a version, one of [`VERSIONS`](Self::VERSIONS).
    ///
    /// # Errors
    /// [`DecodeError::Topic`], [`DecodeError::Body`] or [`DecodeError::Request`].
    fn read(version: u8, topic: u8, body: &[u8]) -> Result<Self, DecodeError>;

    /// Number of the sender's boot, if the message contains it.
    fn boot(&self) -> Option<u32> {
        None
    }
}

impl Payload for Message {
    const VERSIONS: &'static [u8] = &[PROTOCOL_VERSION, protocol_2::VERSION];

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
            Self::Tare(_) => topic::TARE,
        }
    }

    /// A board sends messages of the newest version alone.
    fn write(&self, version: u8, body: &mut [u8]) -> Option<usize> {
        if version != PROTOCOL_VERSION {
            return None;
        }
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
            Self::Tare(report) => write(report, body),
        }
    }

    fn read(version: u8, topic: u8, body: &[u8]) -> Result<Self, DecodeError> {
        if version == protocol_2::VERSION
            && let Some(message) = protocol_2::read_message(topic, body)
        {
            return message.ok_or(DecodeError::Body(topic));
        }
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
            topic::TARE => read(body).map(Self::Tare),
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
    const VERSIONS: &'static [u8] = &[PROTOCOL_VERSION];

    fn topic(&self) -> u8 {
        topic::REQUEST
    }

    fn write(&self, version: u8, body: &mut [u8]) -> Option<usize> {
        if version == protocol_2::VERSION {
            return protocol_2::write_request(self, body);
        }
        write(self, body)
    }

    fn read(_: u8, topic: u8, body: &[u8]) -> Result<Self, DecodeError> {
        if topic != topic::REQUEST {
            return Err(DecodeError::Topic(topic));
        }
        read(body).ok_or_else(|| match postcard::take_from_bytes(body) {
            Ok((id, _)) => DecodeError::Request(id),
            Err(_) => DecodeError::Body(topic),
        })
    }
}
