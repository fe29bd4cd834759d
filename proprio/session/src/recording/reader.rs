//! Reads a recording from its begin to its end, in memory that does not grow with its length.

use std::io::{self, Read};

use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;
use mcap::{McapError, Message};

use super::messages;
use super::read_error::ReadError;
use super::topics::{MARKS, RAW, TRUTH};
use crate::{HostNs, Truth};

/// Longest record that is read, bytes; a longer one has a damaged length.
const MAX_RECORD: usize = 1 << 28;

/// A part of a recording that a session uses.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// Received bytes, and the time of their arrival.
    Bytes(HostNs, Vec<u8>),
    /// The truth of the sample with this tick, which is before it.
    Truth(u32, Vec<Option<Truth>>),
    /// A mark that a person has set: its time and text.
    Mark(HostNs, String),
}

/// True where `begin` is that of an MCAP file.
#[must_use]
pub fn is_recording(begin: &[u8]) -> bool {
    begin.starts_with(mcap::MAGIC)
}

/// Options of MCAP readers: messages of a damaged chunk are refused.
pub(super) fn options() -> LinearReaderOptions {
    LinearReaderOptions::default().with_prevalidate_chunk_crcs(true).with_record_length_limit(MAX_RECORD)
}

/// Reader of a recording.
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

/// The item in a message; `None` on other channels.
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

/// Reader of a raw file: received bytes without times.
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
