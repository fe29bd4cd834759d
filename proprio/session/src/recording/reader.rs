//! A recording that is read from its begin to its end, in memory that does not grow with its length.

use std::io::{self, Read};

use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;
use mcap::{McapError, Message};
use telemetry::PROTOCOL_VERSION;

use super::{MARKS, RAW, TRUTH, messages};
use crate::{HostNs, Truth};

/// No record of ours is longer; a longer one is a damaged length.
const LONGEST_RECORD: usize = 1 << 28;

/// What a recording holds for a session.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// Bytes as they came, and when.
    Bytes(HostNs, Vec<u8>),
    /// The truth of the sample with this tick, which came before.
    Truth(u32, Vec<Option<Truth>>),
    /// A moment that a person has marked, and what for.
    Mark(HostNs, String),
}

/// Why a recording cannot be read on.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system does not give it.
    #[error("cannot be read: {0}")]
    Read(io::Error),
    /// It ends in the middle.
    #[error("the recording was cut: it has no end")]
    Cut,
    /// It is compressed.
    #[error("the recording is compressed with {0}, which proprio does not read")]
    Compressed(String),
    /// It is of a firmware whose messages this program does not know.
    #[error("the messages of its firmware, version {0}, have another form than this proprio reads")]
    OtherForm(String),
    /// It is of a board that spoke another version of the protocol.
    #[error("its board spoke protocol version {0}, and this proprio reads version {PROTOCOL_VERSION}")]
    OtherProtocol(u8),
    /// It is damaged, or no recording of ours.
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

/// Whether a file that begins so is an MCAP file.
#[must_use]
pub fn is_recording(begin: &[u8]) -> bool {
    begin.starts_with(mcap::MAGIC)
}

/// How MCAP files are read: no message of a damaged chunk is taken.
pub(super) fn options() -> LinearReaderOptions {
    LinearReaderOptions::default().with_prevalidate_chunk_crcs(true).with_record_length_limit(LONGEST_RECORD)
}

/// A recording that is being read.
pub struct Reader<R> {
    messages: MessageReader<R>,
}

impl<R: Read> Reader<R> {
    /// Begins at the file's first byte.
    pub fn new(source: R) -> Self {
        Self { messages: MessageReader::new_with_options(source, options()) }
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Item, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.messages.by_ref().find_map(|message| item(message).transpose())
    }
}

/// What a session needs of a message, if anything.
fn item(message: Result<Message<'static>, McapError>) -> Result<Option<Item>, ReadError> {
    let message = message?;
    match message.channel.topic.as_str() {
        RAW => Ok(Some(Item::Bytes(HostNs(message.log_time), message.data.into_owned()))),
        TRUTH => match messages::read_truth(&message.data) {
            Some(ends) => Ok(Some(Item::Truth(message.sequence, ends))),
            None => Err(ReadError::Damaged(format!("a message on {TRUTH} is no truth"))),
        },
        MARKS => match messages::read_mark(&message.data) {
            Some(text) => Ok(Some(Item::Mark(HostNs(message.log_time), text))),
            None => Err(ReadError::Damaged(format!("a message on {MARKS} is no text"))),
        },
        _ => Ok(None),
    }
}

/// Bytes as they came, without the times: the items of a raw file.
pub struct RawReader<R>(R);

impl<R: Read> RawReader<R> {
    /// Begins at the file's first byte.
    pub fn new(source: R) -> Self {
        Self(source)
    }
}

impl<R: Read> Iterator for RawReader<R> {
    type Item = Result<Item, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut bytes = vec![0; 4096];
        loop {
            match self.0.read(&mut bytes) {
                Ok(0) => return None,
                Ok(count) => {
                    bytes.truncate(count);
                    return Some(Ok(Item::Bytes(HostNs(0), bytes)));
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Some(Err(ReadError::Read(error))),
            }
        }
    }
}
