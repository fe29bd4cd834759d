//! The node: a participant of DDS, and a writer for each topic.

use std::net::{IpAddr, Ipv4Addr};

use proprio_foxglove::channels;
use proprio_session::recording::{Channel, MessageInfo, MessageSink};
use rustdds::bytes::Bytes;
use rustdds::dds::{CreateError, WriteError};
use rustdds::no_key::{DataWriter, SerializerAdapter};
use rustdds::policy::{Durability, History, Reliability};
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, Duration, Publisher, QosPolicies, QosPolicyBuilder, RTPSEntity,
    RepresentationIdentifier, Timestamp, TopicKind,
};

use crate::discovery_info;
use crate::environment::Environment;
use crate::error::Error;
use crate::names;

/// Name of the node.
pub const NAME: &str = "/proprio";

/// Bytes of a message in front of its fields: its encoding.
const ENCODING_BYTES: usize = 4;

/// Messages that are kept for a subscriber that has lost some.
const DEPTH: i32 = 10;

/// Time that a message waits for subscribers that are too slow: none, so that the others get the next ones in time.
const NO_WAIT: Duration = Duration::ZERO;

type Writer = DataWriter<Vec<u8>, Encoded>;

/// A node with a writer for each channel of the live stream.
pub struct Node {
    writers: Vec<(&'static Channel, Writer)>,
    /// Messages that were not sent because subscribers were too slow.
    pub unsent: u64,
    // Others forget the node without it.
    _discovery_info: Writer,
    _participant: DomainParticipant,
}

impl Node {
    /// A node that other nodes find from now on.
    pub fn new(environment: &Environment) -> Result<Self, Error> {
        let mut builder = DomainParticipantBuilder::new(environment.domain);
        if environment.is_local {
            builder = builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
        }
        let participant = builder.build()?;
        let publisher = participant.create_publisher(&quality(Durability::Volatile, DEPTH))?;
        let create = |topic: &str, type_name: &str, quality: &QosPolicies| {
            writer(&participant, &publisher, topic, type_name, quality)
        };

        let of_channel = |channel: &'static Channel| {
            let (topic, type_name) = (names::topic(channel.topic), names::type_name(channel.schema.name));
            Ok((channel, create(&topic, &type_name, &quality(Durability::Volatile, DEPTH))?))
        };
        let writers: Vec<_> = channels().map(of_channel).collect::<Result<_, CreateError>>()?;
        // The last message is sent to each node that comes later.
        let last = quality(Durability::TransientLocal, 1);
        let discovery_info = create(discovery_info::TOPIC, discovery_info::TYPE, &last)?;

        let guids: Vec<[u8; 16]> = writers.iter().map(|(_, writer)| writer.guid().to_bytes()).collect();
        let name = NAME.trim_start_matches('/');
        let info = discovery_info::encode(participant.guid().to_bytes(), name, &guids, environment.identifier_bytes);
        write(&discovery_info, info)?;
        Ok(Self { writers, unsent: 0, _discovery_info: discovery_info, _participant: participant })
    }

    /// Publishes a message in CDR on its channel.
    pub fn publish(&mut self, channel: &Channel, message: Vec<u8>) -> Result<(), Error> {
        let of_channel = self.writers.iter().find(|(other, _)| other.topic == channel.topic);
        if let Some((_, writer)) = of_channel
            && !write(writer, message)?
        {
            self.unsent += 1;
        }
        Ok(())
    }
}

impl MessageSink for Node {
    type Error = Error;

    fn message(
        &mut self,
        channel: &'static Channel,
        _: MessageInfo,
        encode: impl FnOnce() -> Vec<u8>,
    ) -> Result<(), Error> {
        self.publish(channel, encode())
    }
}

/// Quality of service that subscribers of both kinds accept, reliable and best effort.
fn quality(durability: Durability, depth: i32) -> QosPolicies {
    QosPolicyBuilder::new()
        .reliability(Reliability::Reliable { max_blocking_time: NO_WAIT })
        .durability(durability)
        .history(History::KeepLast { depth })
        .build()
}

fn writer(
    participant: &DomainParticipant,
    publisher: &Publisher,
    topic: &str,
    type_name: &str,
    quality: &QosPolicies,
) -> Result<Writer, CreateError> {
    let topic = participant.create_topic(topic.to_owned(), type_name.to_owned(), quality, TopicKind::NoKey)?;
    publisher.create_datawriter_no_key(&topic, None)
}

/// Sends a message; false where subscribers are too slow for it.
fn write(writer: &Writer, message: Vec<u8>) -> Result<bool, Error> {
    match writer.write(message, Some(Timestamp::now())) {
        Ok(()) => Ok(true),
        Err(WriteError::WouldBlock { .. }) => Ok(false),
        Err(error) => Err(Error::Write(error.to_string())),
    }
}

/// Messages that are in CDR already.
struct Encoded;

impl SerializerAdapter<Vec<u8>> for Encoded {
    type Error = std::convert::Infallible;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(message: &Vec<u8>) -> Result<Bytes, Self::Error> {
        Ok(Bytes::copy_from_slice(message.get(ENCODING_BYTES..).unwrap_or_default()))
    }
}
