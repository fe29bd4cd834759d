//! Errors of reading a recording.

use std::io;

use mcap::McapError;
use telemetry::PROTOCOL_VERSION;

/// An error that ends the reading of a recording.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system cannot read it.
    #[error("cannot be read: {0}")]
    Read(io::Error),
    /// It ends in the middle.
    #[error("the recording was cut: it has no end")]
    Cut,
    /// It is compressed.
    #[error("the recording is compressed with {0}, which proprio does not read")]
    Compressed(String),
    /// It is of a firmware whose messages have another layout.
    #[error("the messages of its firmware, version {0}, have another form than this proprio reads")]
    OtherForm(String),
    /// It is of a board that used another version of the protocol.
    #[error("its board used protocol version {0}, and this proprio reads version {PROTOCOL_VERSION}")]
    OtherProtocol(u8),
    /// It is damaged, or no recording of proprio.
    #[error("the recording is damaged: {0}")]
    Damaged(String),
}

impl From<McapError> for ReadError {
    fn from(error: McapError) -> Self {
        match error {
            McapError::Io(error) => Self::Read(error),
            McapError::UnexpectedEof | McapError::UnexpectedEoc => Self::Cut,
            McapError::UnsupportedCompression(name) => Self::Compressed(name),
            other => Self::Damaged(other.to_string()),
        }
    }
}
