//! Errors of reading a recording.

use std::io;

use telemetry::{PROTOCOL_VERSION, protocol_2};

use super::topics::{RAW, SAMPLES};
use crate::shown::shown;

/// An error that ends the reading of a recording.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system cannot read it.
    #[error("cannot be read: {0}")]
    Read(io::Error),
    /// It ends in the middle.
    #[error("the recording was cut: it has no end")]
    Cut,
    /// It is of another kind.
    #[error("it is no MCAP file")]
    NoMcap,
    /// It is an MCAP file of another program.
    #[error("is an MCAP file without a board's samples: {RAW} and {SAMPLES} are missing, {}", topics(.0))]
    Foreign(Vec<String>),
    /// It is of a firmware whose messages have another layout.
    #[error("the messages of its firmware, version {}, have another form than this proprio reads", shown(.0))]
    OtherForm(String),
    /// It is of a board that used another version of the protocol.
    #[error("its board used protocol version {0}, and this proprio reads versions {oldest} and {PROTOCOL_VERSION}", oldest = protocol_2::VERSION)]
    OtherProtocol(u8),
    /// It is damaged, or no recording of proprio.
    #[error("the recording is damaged: {0}")]
    Damaged(String),
}

/// The topics of a file, for its reader.
fn topics(names: &[String]) -> String {
    if names.is_empty() {
        "as are all other topics".to_owned()
    } else {
        format!("it has {}", names.iter().map(|name| shown(name)).collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::ReadError;

    #[test]
    fn topics_of_other_programs_are_shown_without_their_control_characters() {
        let message = ReadError::Foreign(vec!["/scan\u{1b}[2J".to_owned()]).to_string();
        assert!(message.ends_with("it has /scan\\u{1b}[2J"), "{message}");
    }
}
