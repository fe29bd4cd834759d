//! Writes a recording.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};
use telemetry::{Estimate, Hello, Message, SCHEMA, Sample, SetPressures};

use super::messages;
use super::own_channels::{BYTES, CDR, METADATA, OWN_CHANNELS, ROS2_MESSAGE};
use super::schema::{self, Schema};
use super::topics::{CONTACT, HISTORY, MARKS, SET_POINTS, TRUTH};
use crate::{ClockSync, HostNs, Truth};

/// Longest time before data is written, ns. A file that is cut loses no more than that.
const FLUSH_NS: u64 = 900_000_000;

/// Length of a chunk of the history, bytes.
const HISTORY_CHUNK: usize = 1 << 20;

/// Writer of a recording. Every second it appends the received data as one complete chunk; written chunks never change.
pub struct Recorder<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    channels: Channels,
    clock: ClockSync,
    hello: Option<Hello>,
    /// Tick and time of the last sample, which its estimate follows at once.
    sample: Option<(u32, HostNs)>,
    /// Segments of the board's arm.
    segments: usize,
    flushed: HostNs,
    raw_messages: u32,
    /// Bytes of the history since the last flush.
    history_bytes: usize,
    samples: u64,
    /// Number of the host's requests for pressures.
    requested: u32,
    marks: u32,
}

/// Numbers of the channels.
struct Channels {
    raw: u16,
    samples: u16,
    joint_states: u16,
    shape: u16,
    diagnostics: u16,
    uncertainty: u16,
    /// Only where the recording does not begin with the stream.
    history: Option<u16>,
    /// Only where something touches the arm.
    contact: Option<u16>,
    /// Only where the pressures are driven.
    set_points: Option<u16>,
    /// Only where there is truth.
    truth: Option<u16>,
    /// Only where there are marks.
    marks: Option<u16>,
}

impl<W: Write> Recorder<W> {
    /// Begins a recording of the line of this name at `at`.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn new(sink: W, at: HostNs, line: &str) -> io::Result<Self> {
        // Chunks are put together in memory, so that the file only grows. Compression would need a C compiler.
        let options = WriteOptions::new()
            .compression(None)
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
        let mut ids = [0; OWN_CHANNELS.len()];
        for (id, (topic, schema)) in ids.iter_mut().zip(OWN_CHANNELS) {
            *id = match schema {
                Some(schema) => channel(&mut mcap, topic, schema)?,
                None => mcap.add_channel(0, topic, BYTES, &BTreeMap::new()).map_err(io_error)?,
            };
        }
        let [raw, samples, joint_states, shape, diagnostics, uncertainty] = ids;
        let channels = Channels {
            raw,
            samples,
            joint_states,
            shape,
            diagnostics,
            uncertainty,
            history: None,
            contact: None,
            set_points: None,
            truth: None,
            marks: None,
        };
        let clock = ClockSync::default();
        Ok(Self {
            mcap,
            channels,
            clock,
            hello: None,
            sample: None,
            segments: 0,
            flushed: at,
            raw_messages: 0,
            history_bytes: 0,
            samples: 0,
            requested: 0,
            marks: 0,
        })
    }

    /// Attaches the board's table, as TOML.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn attach_table(&mut self, at: HostNs, toml: &[u8]) -> io::Result<()> {
        self.attach(at, "table.toml", "application/toml", toml)
    }

    fn attach(&mut self, at: HostNs, name: &str, media_type: &str, data: &[u8]) -> io::Result<()> {
        let (name, media_type) = (name.to_owned(), media_type.to_owned());
        let attachment = Attachment { log_time: at.0, create_time: at.0, name, media_type, data: Cow::Borrowed(data) };
        self.mcap.attach(&attachment).map_err(io_error)
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
        self.raw_messages = self.raw_messages.wrapping_add(1);
        self.write(self.channels.raw, self.raw_messages, at, at, bytes)
    }

    /// Writes bytes that were received before the begin of the recording.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn history(&mut self, at: HostNs, bytes: &[u8]) -> io::Result<()> {
        let channel = if let Some(channel) = self.channels.history {
            channel
        } else {
            let id = self.mcap.add_channel(0, HISTORY, BYTES, &BTreeMap::new());
            *self.channels.history.insert(id.map_err(io_error)?)
        };
        self.raw_messages = self.raw_messages.wrapping_add(1);
        self.write(channel, self.raw_messages, at, at, bytes)?;
        self.history_bytes += bytes.len();
        if self.history_bytes >= HISTORY_CHUNK {
            self.history_bytes = 0;
            self.mcap.flush().map_err(io_error)?;
        }
        Ok(())
    }

    /// Writes a message that was decoded from them.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn message(&mut self, at: HostNs, message: &Message) -> io::Result<()> {
        match message {
            Message::Hello(hello) => self.attach_hello(at, hello),
            Message::Sample(sample) => self.sample(at, sample),
            Message::Estimate(estimate) => self.estimate(at, estimate),
            Message::Health(health) => {
                let stamp = self.stamp(health.tick, at);
                let message = messages::diagnostics(stamp, health, self.hello.as_ref());
                self.write(self.channels.diagnostics, health.tick, at, stamp, &message)
            }
            Message::Uncertainty(of) => {
                let stamp = self.stamp(of.tick, at);
                self.write(self.channels.uncertainty, of.tick, at, stamp, &messages::uncertainty(stamp, of))
            }
            Message::Event(telemetry::Event::Contact(tick, touched)) => self.contact(at, *tick, *touched),
            Message::Event(_) | Message::Reply(_) | Message::Table(_) | Message::TableData(_) | Message::Tare(_) => {
                Ok(())
            }
        }
    }

    fn contact(&mut self, at: HostNs, tick: u32, mask: u8) -> io::Result<()> {
        let channel = channel_once(&mut self.channels.contact, &mut self.mcap, CONTACT, &schema::CONTACT)?;
        let stamp = self.stamp(tick, at);
        self.write(channel, tick, at, stamp, &messages::contact(stamp, mask, self.segments))
    }

    /// Writes the truth of the sample with this tick, which was written before.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn truth(&mut self, at: HostNs, tick: u32, ends: &[Option<Truth>]) -> io::Result<()> {
        let channel = channel_once(&mut self.channels.truth, &mut self.mcap, TRUTH, &schema::TRUTH)?;
        let stamp = self.stamp(tick, at);
        self.write(channel, tick, at, stamp, &messages::truth(stamp, ends))
    }

    /// Writes the pressures that the host has requested.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn set_points(&mut self, at: HostNs, requested: &SetPressures) -> io::Result<()> {
        let channel = channel_once(&mut self.channels.set_points, &mut self.mcap, SET_POINTS, &schema::SET_POINTS)?;
        self.requested = self.requested.wrapping_add(1);
        self.write(channel, self.requested, at, at, &messages::set_points(at, requested))
    }

    /// Writes a mark that a person has set.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn mark(&mut self, at: HostNs, text: &str) -> io::Result<()> {
        let channel = channel_once(&mut self.channels.marks, &mut self.mcap, MARKS, &schema::STRING)?;
        self.marks = self.marks.wrapping_add(1);
        self.write(channel, self.marks, at, at, &messages::mark(text))
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
        self.mcap.flush().map_err(io_error)
    }

    /// Completes the recording with its index and returns the sink.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn finish(mut self) -> io::Result<W> {
        self.mcap.finish().map_err(io_error)?;
        let mut sink = self.mcap.into_inner().into_inner();
        sink.flush()?;
        Ok(sink)
    }

    /// Attaches the `Hello` of each boot once.
    fn attach_hello(&mut self, at: HostNs, hello: &Hello) -> io::Result<()> {
        if self.hello.as_ref() == Some(hello) {
            return Ok(());
        }
        self.hello = Some(hello.clone());
        let json = serde_json::to_vec_pretty(hello).map_err(io::Error::other)?;
        self.attach(at, &format!("hello-boot-{}.json", hello.boot), "application/json", &json)
    }

    fn sample(&mut self, at: HostNs, sample: &Sample) -> io::Result<()> {
        let stamp = self.clock.host_ns(at, sample.time_us);
        self.sample = Some((sample.tick, stamp));
        self.segments = sample.imu.len();
        self.samples += 1;
        self.write(self.channels.samples, sample.tick, at, stamp, &messages::sample(stamp, sample))
    }

    fn estimate(&mut self, at: HostNs, estimate: &Estimate) -> io::Result<()> {
        let stamp = self.stamp(estimate.tick, at);
        let (joint_states, shape) = (self.channels.joint_states, self.channels.shape);
        self.write(joint_states, estimate.tick, at, stamp, &messages::joint_state(stamp, estimate))?;
        self.write(shape, estimate.tick, at, stamp, &messages::pose_array(stamp, estimate))
    }

    /// Time of a tick; that of its arrival where its sample was lost.
    fn stamp(&self, tick: u32, at: HostNs) -> HostNs {
        self.sample.filter(|(last, _)| *last == tick).map_or(at, |(_, stamp)| stamp)
    }

    fn write(&mut self, channel_id: u16, sequence: u32, at: HostNs, stamp: HostNs, data: &[u8]) -> io::Result<()> {
        let header = MessageHeader { channel_id, sequence, log_time: at.0, publish_time: stamp.0 };
        self.mcap.write_to_known_channel(&header, data).map_err(io_error)
    }
}

fn channel<W: Write>(mcap: &mut mcap::Writer<NoSeek<W>>, topic: &str, schema: &Schema) -> io::Result<u16> {
    let id = mcap.add_schema(schema.name, ROS2_MESSAGE, schema.text().as_bytes()).map_err(io_error)?;
    mcap.add_channel(id, topic, CDR, &BTreeMap::new()).map_err(io_error)
}

/// A channel that is added with its first message.
fn channel_once<W: Write>(
    id: &mut Option<u16>,
    mcap: &mut mcap::Writer<NoSeek<W>>,
    topic: &str,
    schema: &Schema,
) -> io::Result<u16> {
    match id {
        Some(channel) => Ok(*channel),
        None => Ok(*id.insert(channel(mcap, topic, schema)?)),
    }
}

/// The error of the sink in an error of the writer.
pub(super) fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
