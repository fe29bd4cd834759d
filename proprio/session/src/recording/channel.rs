//! A channel: a topic, and the schema of its messages.

use super::schema::{self, Schema};
use super::topics;

/// Encoding of received bytes.
const BYTES: &str = "application/octet-stream";
/// Encoding of messages of ROS 2.
const CDR: &str = "cdr";
/// Encoding of their schemas.
pub const ROS2_MESSAGE: &str = "ros2msg";

/// A channel of a recording or of a live stream.
#[derive(Debug)]
pub struct Channel {
    /// Its topic, which no other channel has.
    pub topic: &'static str,
    /// Schema of its messages, which are those of ROS 2 in CDR; `None`: received bytes.
    pub schema: Option<&'static Schema>,
}

impl Channel {
    /// A channel of messages of ROS 2.
    #[must_use]
    pub const fn new(topic: &'static str, schema: &'static Schema) -> Self {
        Self { topic, schema: Some(schema) }
    }

    const fn of_bytes(topic: &'static str) -> Self {
        Self { topic, schema: None }
    }

    /// Encoding of its messages, by its name in MCAP.
    #[must_use]
    pub const fn encoding(&self) -> &'static str {
        if self.schema.is_some() { CDR } else { BYTES }
    }
}

pub static RAW: Channel = Channel::of_bytes(topics::RAW);
pub static HISTORY: Channel = Channel::of_bytes(topics::HISTORY);
pub static SAMPLES: Channel = Channel::new(topics::SAMPLES, &schema::SAMPLE);
pub static JOINT_STATES: Channel = Channel::new(topics::JOINT_STATES, &schema::JOINT_STATE);
pub static SHAPE: Channel = Channel::new(topics::SHAPE, &schema::POSE_ARRAY);
pub static DIAGNOSTICS: Channel = Channel::new(topics::DIAGNOSTICS, &schema::DIAGNOSTIC_ARRAY);
pub static UNCERTAINTY: Channel = Channel::new(topics::UNCERTAINTY, &schema::UNCERTAINTY);
pub static CONTACT: Channel = Channel::new(topics::CONTACT, &schema::CONTACT);
pub static SET_POINTS: Channel = Channel::new(topics::SET_POINTS, &schema::SET_POINTS);
pub static TRUTH: Channel = Channel::new(topics::TRUTH, &schema::TRUTH);
pub static MARKS: Channel = Channel::new(topics::MARKS, &schema::STRING);

/// The channels of what a board sends, decoded.
pub static BOARD_CHANNELS: [&Channel; 6] = [&SAMPLES, &JOINT_STATES, &SHAPE, &DIAGNOSTICS, &UNCERTAINTY, &CONTACT];
