//! The channels that every recording of proprio begins with. Their records stand in the first chunk and in the index alone, so
//! that a file that has lost both needs them from here.

use std::collections::BTreeMap;

use mcap::records::{self, Metadata, SchemaHeader};

use super::channel::{CDR, Channel, DIAGNOSTICS, JOINT_STATES, RAW, ROS2_MESSAGE, SAMPLES, SHAPE, UNCERTAINTY};
use super::summary::Summary;

/// The channels in the order of their numbers, from 1.
pub static OWN_CHANNELS: [&Channel; 6] = [&RAW, &SAMPLES, &JOINT_STATES, &SHAPE, &DIAGNOSTICS, &UNCERTAINTY];

/// Name of the metadata of a recording of proprio, which stand in front of the first chunk.
pub const METADATA: &str = "proprio";

/// True for the metadata of a recording of proprio.
pub fn are_own(metadata: &Metadata) -> bool {
    metadata.name == METADATA
}

impl Summary {
    /// Adds the channels of a recording of proprio that are not in the index.
    pub fn add_own_channels(&mut self) {
        for (id, channel) in (1..).zip(OWN_CHANNELS) {
            // Each has a schema of its own, so that their numbers are the same.
            let schema = channel.schema;
            let header = SchemaHeader { id, name: schema.name.to_owned(), encoding: ROS2_MESSAGE.to_owned() };
            self.schemas.entry(id).or_insert_with(|| (header, schema.text().into_bytes()));
            let (topic, message_encoding) = (channel.topic.to_owned(), CDR.to_owned());
            let channel = records::Channel { id, schema_id: id, topic, message_encoding, metadata: BTreeMap::new() };
            self.channels.entry(id).or_insert(channel);
        }
    }
}
