//! Reads a recording from its begin to its end, in memory that does not grow with its length.

use std::collections::BTreeMap;
use std::io::{self, Read};

use mcap::records::{Record, op};
use telemetry::Sample;

use super::form;
use super::hole::Hole;
use super::messages;
use super::own_channels::{OWN_CHANNELS, are_own};
use super::read_error::ReadError;
use super::scanner::{Part, Scanner};
use super::summary::Summary;
use super::topics::{HISTORY, MARKS, RAW, SAMPLES, SET_POINTS, TRUTH};
use crate::{HostNs, Truth};

/// Length that no header reaches: it has two short names.
const LONGEST_HEADER: u64 = 1 << 16;

/// A part of a recording that a session uses.
#[derive(Debug, Clone, PartialEq)]
pub enum Item {
    /// Received bytes, and the time of their arrival.
    Bytes(HostNs, Vec<u8>),
    /// Bytes received before the begin of the recording, and the time of their arrival.
    History(HostNs, Vec<u8>),
    /// A decoded sample and the time of its arrival, in a recording without the received bytes.
    Sample(HostNs, Sample),
    /// The truth of the sample with this tick, which is before it.
    Truth(u32, Vec<Option<Truth>>),
    /// A mark that a person has set: its time and text.
    Mark(HostNs, String),
    /// Pressures of the regulators that the host has requested, Pa.
    SetPoints(Vec<u32>),
    /// A damaged part, which is left out.
    Hole(Hole),
}

/// True where `begin` is that of an MCAP file.
#[must_use]
pub fn is_recording(begin: &[u8]) -> bool {
    begin.starts_with(mcap::MAGIC)
}

/// True where `begin` is that of an MCAP file whose magic bytes are damaged: its header follows them.
pub(crate) fn is_damaged_begin(begin: &[u8]) -> bool {
    let header = begin.get(mcap::MAGIC.len()..).and_then(form::head);
    !is_recording(begin) && header.is_some_and(|(opcode, length)| opcode == op::HEADER && length < LONGEST_HEADER)
}

/// Reader of a recording. Damaged parts are [`Item::Hole`].
pub struct Reader<R> {
    scanner: Scanner<R>,
    /// Topics of the channels.
    topics: BTreeMap<u16, String>,
    /// Topics that a recording of proprio has in any case.
    own: Vec<(u16, &'static str)>,
    has_messages: bool,
    has_damage: bool,
    at_end: bool,
}

impl<R: Read> Reader<R> {
    /// Begins at the file's first byte.
    pub fn new(source: R) -> Self {
        Self::with_summary(source, Summary::default())
    }

    /// Begins at the file's first byte. `summary` has the channels where the first chunk is damaged.
    pub(crate) fn with_summary(source: R, summary: Summary) -> Self {
        let topics = summary.channels.into_iter().map(|(id, channel)| (id, channel.topic)).collect();
        Self {
            scanner: Scanner::new(source),
            topics,
            own: Vec::new(),
            has_messages: false,
            has_damage: false,
            at_end: false,
        }
    }

    fn next_item(&mut self) -> Result<Option<Item>, ReadError> {
        while let Some(part) = self.scanner.next_part()? {
            let (opcode, body) = match part {
                Part::Record(opcode, body) => (opcode, self.scanner.body(body)),
                Part::Hole(hole) => {
                    self.has_damage = true;
                    // Their records may be in it.
                    for (id, topic) in std::mem::take(&mut self.own) {
                        self.topics.entry(id).or_insert_with(|| topic.to_owned());
                    }
                    return Ok(Some(Item::Hole(hole)));
                }
                // No part of the session.
                Part::DamagedAbout => continue,
            };
            if !matches!(opcode, op::CHANNEL | op::MESSAGE | op::METADATA) {
                continue;
            }
            match mcap::parse_record(opcode, body) {
                Ok(Record::Metadata(metadata)) if are_own(&metadata) => {
                    self.own = (1..).zip(OWN_CHANNELS.map(|channel| channel.topic)).collect();
                }
                Ok(Record::Channel(channel)) => {
                    self.topics.insert(channel.id, channel.topic);
                }
                Ok(Record::Message { header, data }) => {
                    let Some(topic) = self.topics.get(&header.channel_id) else { continue };
                    let has_raw = || self.topics.values().any(|topic| topic == RAW);
                    if topic == SAMPLES && has_raw() {
                        continue;
                    }
                    self.has_messages |= topic == RAW || topic == SAMPLES;
                    if let Some(item) = item(topic, HostNs(header.log_time), header.sequence, &data)? {
                        return Ok(Some(item));
                    }
                }
                _ => {}
            }
        }
        self.check_end()?;
        Ok(None)
    }

    fn check_end(&self) -> Result<(), ReadError> {
        if self.scanner.is_cut() {
            return Err(ReadError::Cut);
        }
        let is_ours = self.topics.values().any(|topic| topic == RAW || topic == SAMPLES);
        if is_ours || self.has_messages || self.has_damage {
            return Ok(());
        }
        let mut topics: Vec<String> = self.topics.values().cloned().collect();
        topics.sort();
        topics.dedup();
        Err(ReadError::Foreign(topics))
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Item, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.at_end {
            return None;
        }
        let item = self.next_item().transpose();
        self.at_end = !matches!(item, Some(Ok(_)));
        item
    }
}

/// The item in a message; `None` on other channels.
fn item(topic: &str, at: HostNs, sequence: u32, data: &[u8]) -> Result<Option<Item>, ReadError> {
    let item = match topic {
        RAW => Some(Item::Bytes(at, received(data))),
        HISTORY => Some(Item::History(at, received(data))),
        SAMPLES => messages::read_sample(data).map(|sample| Item::Sample(at, sample)),
        TRUTH => messages::read_truth(data).map(|ends| Item::Truth(sequence, ends)),
        // Versions before 0.3 have another form of it, which is no part of a session.
        SET_POINTS => return Ok(messages::read_set_points(data).map(Item::SetPoints)),
        MARKS => messages::read_mark(data).map(|text| Item::Mark(at, text)),
        _ => return Ok(None),
    };
    item.map(Some).ok_or_else(|| ReadError::Damaged(format!("a message on {topic} cannot be decoded")))
}

/// The received bytes in a message.
fn received(data: &[u8]) -> Vec<u8> {
    messages::read_bytes(data).unwrap_or(data).to_vec()
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
