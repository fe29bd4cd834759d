//! The channels of the stream: those of a recording that viewers can decode, and two for 3D panels. The raw bytes are not among
//! them: viewers report a channel without a schema as an error.

use proprio_session::recording::{BOARD_CHANNELS, Channel};

use crate::scene_schemas::{MARKER_ARRAY, TF_MESSAGE};

/// Number of channels.
pub const COUNT: usize = BOARD_CHANNELS.len() + 2;

/// Transforms from the base to the end of each segment.
pub static TRANSFORMS: Channel = Channel::new("/tf", &TF_MESSAGE);
/// The arm and its ellipses.
pub static ARM: Channel = Channel::new("/proprio/arm", &MARKER_ARRAY);

/// All channels of the live stream, in the order of their numbers, from 0.
pub fn all() -> impl Iterator<Item = &'static Channel> {
    BOARD_CHANNELS.into_iter().chain([&TRANSFORMS, &ARM])
}

/// Number of a channel of the stream.
pub fn number(channel: &Channel) -> Option<usize> {
    all().position(|other| other.topic == channel.topic)
}
