//! Recovery of a recording that was cut or damaged.

use std::collections::BTreeSet;
use std::io::{self, Read, Seek, Write};

use mcap::records::Record;
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};

use super::form;
use super::hole::Hole;
use super::own_channels::are_own;
use super::read_error::ReadError;
use super::scanner::{Part, Scanner};
use super::summary::Summary;
use super::writer::io_error;

/// Length that no header reaches, bytes: it has two short names.
const LONGEST_HEADER: u64 = 1 << 10;

/// Result of a recovery.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Recovery {
    /// Number of recovered messages.
    pub messages: u64,
    /// Number of messages of the source by its index; `None` where that is damaged or absent.
    pub recorded: Option<u64>,
    /// Times of the first and the last message, ns since 1970.
    pub times_ns: Option<(u64, u64)>,
    /// Begin of the recording, ns since 1970: its first message, also where that is damaged and the index is whole.
    pub start_ns: u64,
    /// Bytes of the source.
    pub bytes: u64,
    /// The source was cut.
    pub was_cut: bool,
    /// Where it was cut before the end of its data: bytes of its last part, which is left out.
    pub lost_end: Option<u64>,
    /// The source's index is damaged, which is made again.
    pub index_was_damaged: bool,
    /// The damaged parts, which are left out.
    pub holes: Vec<Hole>,
    /// Number of damaged attachments and metadata, which are left out.
    pub lost_attachments: u64,
    /// Number of messages that are left out as their channel is damaged.
    pub lost_messages: u64,
}

impl Recovery {
    /// True where a part of the source is damaged and left out.
    #[must_use]
    pub fn is_damaged(&self) -> bool {
        !self.holes.is_empty() || self.lost_attachments > 0 || self.lost_messages > 0
    }

    /// True where a part of the data is lost.
    #[must_use]
    pub fn has_loss(&self) -> bool {
        self.is_damaged() || self.lost_end.is_some()
    }

    /// Share of the source's bytes that are not in a hole.
    #[must_use]
    pub fn kept(&self) -> f64 {
        let lost: u64 = self.holes.iter().map(|hole| hole.bytes).sum();
        1.0 - lost as f64 / self.bytes.max(1) as f64
    }
}

/// An error that ends a recovery.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// The source cannot be read.
    #[error("cannot be read: {0}")]
    Read(io::Error),
    /// The source is no recording.
    #[error(transparent)]
    Source(#[from] ReadError),
    /// The sink cannot be written.
    #[error(transparent)]
    Sink(io::Error),
}

/// Copies the whole parts of a recording, uncompressed and with a new index, to its end or to where it was cut.
///
/// # Errors
/// [`RecoverError`].
pub fn recover(mut source: impl Read + Seek, sink: impl Write) -> Result<Recovery, RecoverError> {
    let summary = Summary::of(&mut source).map_err(RecoverError::Read)?;
    let library = format!("proprio {} recover", env!("CARGO_PKG_VERSION"));
    let profile = profile(&mut source).map_err(RecoverError::Read)?;
    let options_out = WriteOptions::new().compression(None).profile(profile).library(library).disable_seeking(true);
    let mcap = options_out.create(NoSeek::new(sink)).map_err(sink_error)?;
    let statistics = summary.statistics.as_ref();
    let recorded = statistics.map(|statistics| statistics.message_count);
    let start_ns = statistics.map(|statistics| statistics.message_start_time);
    let done = Recovery { recorded, ..Recovery::default() };
    let mut copy = Copy { mcap, summary, is_own: false, channels: BTreeSet::new(), done };
    let mut scanner = Scanner::new(source);
    while let Some(part) = scanner.next_part().map_err(source_error)? {
        match part {
            Part::Record(opcode, body) => match mcap::parse_record(opcode, scanner.body(body)) {
                Ok(record) => copy.record(record).map_err(sink_error)?,
                Err(_) => copy.done.lost_messages += 1,
            },
            Part::Hole(hole) => {
                copy.done.holes.push(hole);
                if copy.is_own {
                    // Their records may be in it.
                    copy.summary.add_own_channels();
                }
            }
            Part::DamagedAbout => copy.done.lost_attachments += 1,
        }
    }
    copy.mcap.finish().map_err(sink_error)?;
    let mut done = copy.done;
    done.bytes = scanner.bytes();
    done.was_cut = scanner.is_cut();
    done.lost_end = scanner.lost_end();
    done.index_was_damaged = scanner.index_is_damaged();
    done.start_ns = start_ns.or(done.times_ns.map(|(first, _)| first)).unwrap_or_default();
    Ok(done)
}

/// The profile of a file by its header, which is its first record; none where that is damaged. Goes back to the file's begin.
fn profile(file: &mut (impl Read + Seek)) -> io::Result<String> {
    let mut begin = Vec::new();
    file.by_ref().take(LONGEST_HEADER).read_to_end(&mut begin)?;
    file.rewind()?;
    let header = begin.get(mcap::MAGIC.len()..).and_then(form::split_record);
    let header = header.and_then(|(opcode, body, _)| mcap::parse_record(opcode, body).ok());
    Ok(if let Some(Record::Header(header)) = header { header.profile } else { String::new() })
}

fn source_error(error: ReadError) -> RecoverError {
    match error {
        ReadError::Read(error) => RecoverError::Read(error),
        error => RecoverError::Source(error),
    }
}

fn sink_error(error: McapError) -> RecoverError {
    RecoverError::Sink(io_error(error))
}

struct Copy<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    summary: Summary,
    /// The source is a recording of proprio.
    is_own: bool,
    /// The channels of the copy.
    channels: BTreeSet<u16>,
    done: Recovery,
}

impl<W: Write> Copy<W> {
    fn record(&mut self, record: Record<'_>) -> Result<(), McapError> {
        match record {
            Record::Schema { header, data } => {
                let added = self.mcap.add_schema_with_id(header.id, &header.name, &header.encoding, &data);
                unless_damaged(added).map(|_| ())
            }
            Record::Channel(channel) => self.channel(&channel),
            Record::Message { header, data } => {
                if !self.channels.contains(&header.channel_id) {
                    self.channel_of_index(header.channel_id)?;
                }
                if !self.channels.contains(&header.channel_id) {
                    self.done.lost_messages += 1;
                    return Ok(());
                }
                let (first, last) = self.done.times_ns.unwrap_or((header.log_time, header.log_time));
                self.done.times_ns = Some((first.min(header.log_time), last.max(header.log_time)));
                self.done.messages += 1;
                self.mcap.write_to_known_channel(&header, &data)
            }
            Record::Attachment { header, data, .. } => self.mcap.attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            }),
            Record::Metadata(metadata) => {
                self.is_own |= are_own(&metadata);
                self.mcap.write_metadata(&metadata)
            }
            _ => Ok(()),
        }
    }

    fn channel(&mut self, channel: &mcap::records::Channel) -> Result<(), McapError> {
        let (id, schema) = (channel.id, channel.schema_id);
        let (topic, encoding) = (&channel.topic, &channel.message_encoding);
        if unless_damaged(self.mcap.add_channel_with_id(id, schema, topic, encoding, &channel.metadata))?.is_some() {
            self.channels.insert(id);
        }
        Ok(())
    }

    /// Adds a channel of the index, as the source's own is damaged.
    fn channel_of_index(&mut self, id: u16) -> Result<(), McapError> {
        let Some(channel) = self.summary.channels.get(&id).cloned() else { return Ok(()) };
        if let Some((header, data)) = self.summary.schemas.get(&channel.schema_id) {
            unless_damaged(self.mcap.add_schema_with_id(header.id, &header.name, &header.encoding, data))?;
        }
        self.channel(&channel)
    }
}

/// The result of an addition; `None` where a damaged source does not allow it.
fn unless_damaged<T>(added: Result<T, McapError>) -> Result<Option<T>, McapError> {
    match added {
        Ok(added) => Ok(Some(added)),
        Err(McapError::Io(error)) => Err(McapError::Io(error)),
        Err(_) => Ok(None),
    }
}
