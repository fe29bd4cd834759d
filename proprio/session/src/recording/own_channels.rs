//! The channels that every recording of proprio begins with. Their records stand in the first chunk and in the index alone, so
//! that a file that has lost both needs them from here.

use std::collections::BTreeMap;

use mcap::records::{Channel, Metadata, SchemaHeader};

use super::schema::{self, Schema};
use super::summary::Summary;
use super::topics::{DIAGNOSTICS, JOINT_STATES, RAW, SAMPLES, SHAPE, UNCERTAINTY};

/// Topics in the order of the channels' numbers, from 1, with the schemas of those that have one.
pub const OWN_CHANNELS: [(&str, Option<&Schema>); 6] = [
    (RAW, None),
    (SAMPLES, Some(&schema::SAMPLE)),
    (JOINT_STATES, Some(&schema::JOINT_STATE)),
    (SHAPE, Some(&schema::POSE_ARRAY)),
    (DIAGNOSTICS, Some(&schema::DIAGNOSTIC_ARRAY)),
    (UNCERTAINTY, Some(&schema::UNCERTAINTY)),
];

/// Encoding of received bytes, and of messages of ROS 2 and their schemas.
pub const BYTES: &str = "application/octet-stream";
pub const CDR: &str = "cdr";
pub const ROS2_MESSAGE: &str = "ros2msg";

/// Name of the metadata of a recording of proprio, which stand in front of the first chunk.
pub const METADATA: &str = "proprio";

/// True for the metadata of a recording of proprio.
pub fn are_own(metadata: &Metadata) -> bool {
    metadata.name == METADATA
}

impl Summary {
    /// Adds the channels of a recording of proprio that are not in the index.
    pub fn add_own_channels(&mut self) {
        let mut schemas = 0;
        for (id, (topic, schema)) in (1..).zip(OWN_CHANNELS) {
            let schema_id = schema.map_or(0, |schema| {
                schemas += 1;
                let header =
                    SchemaHeader { id: schemas, name: schema.name.to_owned(), encoding: ROS2_MESSAGE.to_owned() };
                self.schemas.entry(schemas).or_insert_with(|| (header, schema.text().into_bytes()));
                schemas
            });
            let message_encoding = if schema.is_some() { CDR } else { BYTES }.to_owned();
            let topic = topic.to_owned();
            let channel = Channel { id, schema_id, topic, message_encoding, metadata: BTreeMap::new() };
            self.channels.entry(id).or_insert(channel);
        }
    }
}
