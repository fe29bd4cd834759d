//! Errors of decoding.

use crate::constants::{MAX_FRAME, PROTOCOL_VERSION};

/// Reason for which a frame gave no message. The decoder continues with the next frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Wrong COBS code, wrong CRC-32, or shorter than the header of its version.
    #[error("a frame was damaged on the line and is skipped")]
    Damaged,
    /// Longer than any frame of this version: the zero that ends it was damaged, or it is of another version.
    #[error("a frame is longer than {MAX_FRAME} bytes and is skipped")]
    Oversize,
    /// A valid frame of another version of the protocol, of any length.
    #[error("a frame is of protocol version {0}, not {PROTOCOL_VERSION}: use host tool and firmware of one release")]
    Version(u8),
    /// A valid frame of an unknown topic.
    #[error("a frame has the unknown topic {0}: host tool or firmware is the newer one; it is skipped")]
    Topic(u8),
    /// A valid frame of a known topic whose body has another layout.
    #[error("a frame of topic {0} has a body of another schema: use host tool and firmware of one release")]
    Body(u8),
    /// A valid request with this number and an unknown command: refuse it.
    #[error("request {0} has an unknown command: use host tool and firmware of one release")]
    Request(u32),
}
