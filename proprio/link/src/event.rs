//! Events of the link's thread.

use std::fmt;
use std::sync::Arc;

use proprio_session::HostNs;
use telemetry::{DecodeError, Message, PROTOCOL_VERSION, SCHEMA, SetPressures, protocol_2};

/// An event on the link.
#[derive(Debug, Clone)]
pub struct LinkEvent {
    /// Time of the event; for bytes and the messages in them, that of their arrival.
    pub at: HostNs,
    /// Gaps in the stream before the event: lost frames, and openings of the line after the first.
    pub gaps: u32,
    /// Its kind and contents.
    pub kind: EventKind,
}

/// Kind of an event, and its contents.
#[derive(Debug, Clone)]
pub enum EventKind {
    /// The line of this name was opened.
    Opened(String),
    /// The line was lost, for this reason. It is opened again when it comes back.
    Lost(String),
    /// The line is gone for good, for this reason. No event follows.
    Ended(String),
    /// Received bytes. The messages in them follow.
    Bytes(Arc<[u8]>),
    /// A message of the board.
    Message(Message),
    /// The host has requested pressures; none where it has vented the arm.
    SetPoints(SetPressures),
    /// A frame that is not a valid message.
    Undecoded(DecodeError),
    /// The board has restarted, which is no loss of frames. Its `Hello` follows, or was lost.
    Restarted,
    /// Board and host are not of the same release or table.
    Mismatch(Mismatch),
}

impl EventKind {
    /// A warning for people, where the event is out of the ordinary.
    #[must_use]
    pub fn warning(&self) -> Option<String> {
        match self {
            Self::Lost(reason) => Some(format!("{reason}; waiting for it to come back")),
            Self::Ended(reason) => Some(reason.clone()),
            Self::Restarted => Some("the board has restarted".to_owned()),
            Self::Mismatch(mismatch) => Some(mismatch.to_string()),
            Self::Opened(_) | Self::Bytes(_) | Self::Message(_) | Self::SetPoints(_) | Self::Undecoded(_) => None,
        }
    }
}

/// A difference between board and host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Mismatch {
    /// The board uses another version of the protocol; none of its messages can be decoded.
    Protocol(u8),
    /// Its messages have another layout; only its `Hello` is passed on.
    Schema {
        /// The board's, where its `Hello` could be read.
        board: Option<u32>,
        /// The version of its firmware, likewise.
        firmware: Option<String>,
    },
    /// Its firmware is of another version with the same messages.
    Firmware(String),
    /// Its table is not the one that was given.
    Table {
        /// Name of the arm that the board's table is for.
        arm: String,
        /// Checksum of the board's table.
        board: u32,
        /// Checksum of the table that was given.
        given: u32,
    },
}

impl Mismatch {
    /// The board's table is not the one that was given.
    #[must_use]
    pub const fn is_table(&self) -> bool {
        matches!(self, Self::Table { .. })
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let host = env!("CARGO_PKG_VERSION");
        match self {
            Self::Protocol(version) => write!(
                f,
                "the board speaks protocol version {version}, proprio {host} versions {} and {PROTOCOL_VERSION}: flash the \
                 firmware of this release",
                protocol_2::VERSION
            ),
            Self::Schema { board, firmware } => {
                let firmware = firmware.as_deref().unwrap_or("of another version");
                let board = board.map_or_else(|| "unknown".to_owned(), |board| format!("{board:08x}"));
                write!(
                    f,
                    "the messages of firmware {firmware} have another form (schema {board}) than those of proprio {host} \
                     ({SCHEMA:08x}) and are not read: flash the firmware of this release"
                )
            }
            Self::Firmware(firmware) => {
                write!(f, "the board's firmware is version {firmware}, proprio is {host}; they understand each other")
            }
            Self::Table { arm, board, given } => write!(
                f,
                "the board estimates with another table (of arm \"{arm}\", checksum {board:08x}) than the one given \
                 ({given:08x}): `proprio table push` stores that on it, or give the board's table"
            ),
        }
    }
}
