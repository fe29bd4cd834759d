//! A channel: a topic, and the schema of its messages.

use super::schema::{self, Schema};
use super::topics;

/// Encoding of messages of ROS 2.
pub const CDR: &str = "cdr";
/// Encoding of their schemas.
pub const ROS2_MESSAGE: &str = "ros2msg";
/// Profile of a recording whose messages are all of ROS 2.
pub const ROS2_PROFILE: &str = "ros2";

/// A channel of a recording or of a live stream, of messages of ROS 2 in [`CDR`].
#[derive(Debug)]
pub struct Channel {
    /// Its topic, which no other channel has.
    pub topic: &'static str,
    /// Schema of its messages.
    pub schema: &'static Schema,
}

impl Channel {
    /// A channel.
    #[must_use]
    pub const fn new(topic: &'static str, schema: &'static Schema) -> Self {
        Self { topic, schema }
    }
}

pub static RAW: Channel = Channel::new(topics::RAW, &schema::UINT8_MULTI_ARRAY);
pub static HISTORY: Channel = Channel::new(topics::HISTORY, &schema::UINT8_MULTI_ARRAY);
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
