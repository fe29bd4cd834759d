//! Writes a recording.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};
use telemetry::{Hello, Message, SCHEMA, SetPressures};

use super::attached_table::TABLE;
use super::board_messages::{BoardMessages, MessageInfo, MessageSink};
use super::channel::{CDR, Channel, HISTORY, MARKS, RAW, ROS2_MESSAGE, ROS2_PROFILE, SET_POINTS, TRUTH};
use super::messages;
use super::own_channels::{METADATA, OWN_CHANNELS};
use crate::{HostNs, Truth};

/// Longest time before data is written, ns. A file that is cut loses no more than that.
const FLUSH_NS: u64 = 900_000_000;

/// Length of a chunk of the history, bytes.
const HISTORY_CHUNK: usize = 1 << 20;

/// Writer of a recording. Every second it appends the received data as one complete chunk; written chunks never change.
pub struct Recorder<W: Write> {
    file: McapFile<W>,
    board: BoardMessages,
    flushed: HostNs,
    raw_messages: u32,
    /// Bytes of the history since the last flush.
    history_bytes: usize,
    samples: u64,
    /// Number of the host's requests for pressures.
    requested: u32,
    marks: u32,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording of the line of this name at `at`.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn new(sink: W, at: HostNs, line: &str) -> io::Result<Self> {
        let file = McapFile::new(sink, line)?;
        let board = BoardMessages::new();
        Ok(Self { file, board, flushed: at, raw_messages: 0, history_bytes: 0, samples: 0, requested: 0, marks: 0 })
    }

    /// Attaches the board's table, as TOML.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn attach_table(&mut self, at: HostNs, toml: &[u8]) -> io::Result<()> {
        self.attach(at, TABLE, "application/toml", toml)
    }

    fn attach(&mut self, at: HostNs, name: &str, media_type: &str, data: &[u8]) -> io::Result<()> {
        let (name, media_type) = (name.to_owned(), media_type.to_owned());
        let attachment = Attachment { log_time: at.0, create_time: at.0, name, media_type, data: Cow::Borrowed(data) };
        self.file.mcap.attach(&attachment).map_err(io_error)
    }

    /// Number of samples so far.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Writes received bytes.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn bytes(&mut self, at: HostNs, bytes: &[u8]) -> io::Result<()> {
        self.flush_if_due(at)?;
        self.raw_bytes(&RAW, at, bytes)
    }

    /// Writes bytes that were received before the begin of the recording.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn history(&mut self, at: HostNs, bytes: &[u8]) -> io::Result<()> {
        self.raw_bytes(&HISTORY, at, bytes)?;
        self.history_bytes += bytes.len();
        if self.history_bytes >= HISTORY_CHUNK {
            self.history_bytes = 0;
            self.file.mcap.flush().map_err(io_error)?;
        }
        Ok(())
    }

    fn raw_bytes(&mut self, channel: &'static Channel, at: HostNs, bytes: &[u8]) -> io::Result<()> {
        self.raw_messages = self.raw_messages.wrapping_add(1);
        let info = MessageInfo { sequence: self.raw_messages, at, stamp: at };
        self.file.write(channel, info, &messages::bytes(bytes))
    }

    /// Writes a message that was decoded from them.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn message(&mut self, at: HostNs, message: &Message) -> io::Result<()> {
        match message {
            Message::Hello(hello) => self.attach_hello(at, hello)?,
            Message::Sample(_) => self.samples += 1,
            _ => {}
        }
        self.board.message(at, message, &mut self.file)
    }

    /// Writes the truth of the sample with this tick, which was written before.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn truth(&mut self, at: HostNs, tick: u32, ends: &[Option<Truth>]) -> io::Result<()> {
        let info = self.board.info(tick, at);
        self.file.write(&TRUTH, info, &messages::truth(info.stamp, ends))
    }

    /// Writes the pressures that the host has requested.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn set_points(&mut self, at: HostNs, requested: &SetPressures) -> io::Result<()> {
        self.requested = self.requested.wrapping_add(1);
        let info = MessageInfo { sequence: self.requested, at, stamp: at };
        self.file.write(&SET_POINTS, info, &messages::set_points(at, requested))
    }

    /// Writes a mark that a person has set.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn mark(&mut self, at: HostNs, text: &str) -> io::Result<()> {
        self.marks = self.marks.wrapping_add(1);
        self.file.write(&MARKS, MessageInfo { sequence: self.marks, at, stamp: at }, &messages::mark(text))
    }

    /// Writes buffered data that has waited long enough.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn flush_if_due(&mut self, now: HostNs) -> io::Result<()> {
        if now.0.saturating_sub(self.flushed.0) < FLUSH_NS {
            return Ok(());
        }
        self.flushed = now;
        self.file.mcap.flush().map_err(io_error)
    }

    /// Completes the recording with its index and returns the sink.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn finish(mut self) -> io::Result<W> {
        self.file.mcap.finish().map_err(io_error)?;
        let mut sink = self.file.mcap.into_inner().into_inner();
        sink.flush()?;
        Ok(sink)
    }

    /// Attaches the `Hello` of each boot once.
    fn attach_hello(&mut self, at: HostNs, hello: &Hello) -> io::Result<()> {
        if self.board.hello() == Some(hello) {
            return Ok(());
        }
        let json = serde_json::to_vec_pretty(hello).map_err(io::Error::other)?;
        self.attach(at, &format!("hello-boot-{}.json", hello.boot), "application/json", &json)
    }
}

/// The file and its channels.
struct McapFile<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    /// Topics and numbers of the channels so far.
    channels: Vec<(&'static str, u16)>,
}

impl<W: Write> McapFile<W> {
    fn new(sink: W, line: &str) -> io::Result<Self> {
        // Chunks are put together in memory, so that the file only grows. Compression would need a C compiler.
        let options = WriteOptions::new()
            .compression(None)
            .profile(ROS2_PROFILE)
            .library(format!("proprio {}", env!("CARGO_PKG_VERSION")))
            .chunk_size(None)
            .disable_seeking(true);
        let mut mcap = options.create(NoSeek::new(sink)).map_err(io_error)?;
        let about = [
            ("proprio", env!("CARGO_PKG_VERSION").to_owned()),
            ("line", line.to_owned()),
            ("protocol", telemetry::PROTOCOL_VERSION.to_string()),
            ("schema", format!("{SCHEMA:08x}")),
        ];
        let metadata = about.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        mcap.write_metadata(&Metadata { name: METADATA.to_owned(), metadata }).map_err(io_error)?;
        let mut file = Self { mcap, channels: Vec::new() };
        for channel in OWN_CHANNELS {
            file.id(channel)?;
        }
        Ok(file)
    }

    /// Number of a channel, which is added with its first message unless every recording has it.
    fn id(&mut self, channel: &'static Channel) -> io::Result<u16> {
        if let Some((_, id)) = self.channels.iter().find(|(topic, _)| *topic == channel.topic) {
            return Ok(*id);
        }
        let schema = channel.schema;
        let schema = self.mcap.add_schema(schema.name, ROS2_MESSAGE, schema.text().as_bytes());
        let id = schema.and_then(|id| self.mcap.add_channel(id, channel.topic, CDR, &BTreeMap::new()));
        let id = id.map_err(io_error)?;
        self.channels.push((channel.topic, id));
        Ok(id)
    }

    fn write(&mut self, channel: &'static Channel, info: MessageInfo, data: &[u8]) -> io::Result<()> {
        let MessageInfo { sequence, at, stamp } = info;
        let header = MessageHeader { channel_id: self.id(channel)?, sequence, log_time: at.0, publish_time: stamp.0 };
        self.mcap.write_to_known_channel(&header, data).map_err(io_error)
    }
}

impl<W: Write> MessageSink for McapFile<W> {
    type Error = io::Error;

    fn message(
        &mut self,
        channel: &'static Channel,
        info: MessageInfo,
        encode: impl FnOnce() -> Vec<u8>,
    ) -> io::Result<()> {
        self.write(channel, info, &encode())
    }
}

/// The error of the sink in an error of the writer.
pub(super) fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
