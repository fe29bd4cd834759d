//! Recovery of a recording that was cut.

use std::io::{self, Read, Write};

use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};

use super::read_error::ReadError;
use super::reader::options;
use super::writer::io_error;

/// Result of a recovery.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Recovery {
    /// Number of recovered messages.
    pub messages: u64,
    /// Times of the first and the last message, ns since 1970.
    pub times_ns: Option<(u64, u64)>,
    /// Bytes of the source up to its cut.
    pub bytes: u64,
    /// The source was cut.
    pub was_cut: bool,
}

/// An error that ends a recovery.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// The source cannot be read.
    #[error("cannot be read: {0}")]
    Read(io::Error),
    /// The source is no recording, or has no complete chunk.
    #[error(transparent)]
    Source(#[from] ReadError),
    /// The sink cannot be written.
    #[error(transparent)]
    Sink(io::Error),
}

/// Copies a recording, chunk by chunk, until its end or to where it was cut or is damaged.
///
/// # Errors
/// [`RecoverError`].
pub fn recover(mut source: impl Read, sink: impl Write) -> Result<Recovery, RecoverError> {
    let library = format!("proprio {} recover", env!("CARGO_PKG_VERSION"));
    let options_out = WriteOptions::new().compression(None).library(library).disable_seeking(true);
    let mut copy = Copy { mcap: options_out.create(NoSeek::new(sink)).map_err(sink_error)?, done: Recovery::default() };
    let mut reader = LinearReader::new_with_options(options());
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                let count = read(&mut source, reader.insert(need)).map_err(RecoverError::Read)?;
                copy.done.bytes += count as u64;
                reader.notify_read(count);
            }
            Ok(LinearReadEvent::Record { opcode, data }) => match mcap::parse_record(opcode, data) {
                // The index follows. It is written again for the copy, also where the source was cut before it.
                Ok(Record::DataEnd(_)) => {}
                Ok(record) => copy.record(record).map_err(sink_error)?,
                Err(_) => copy.done.was_cut = true,
            },
            Err(McapError::BadMagic) if copy.done.bytes <= mcap::MAGIC.len() as u64 => {
                return Err(ReadError::Damaged("it is no MCAP file".to_owned()).into());
            }
            Err(_) => {
                copy.done.was_cut = true;
                break;
            }
        }
    }
    copy.mcap.finish().map_err(sink_error)?;
    Ok(copy.done)
}

fn sink_error(error: McapError) -> RecoverError {
    RecoverError::Sink(io_error(error))
}

fn read(source: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match source.read(buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

struct Copy<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    done: Recovery,
}

impl<W: Write> Copy<W> {
    fn record(&mut self, record: Record<'_>) -> Result<(), McapError> {
        match record {
            Record::Schema { header, data } => {
                self.mcap.add_schema_with_id(header.id, &header.name, &header.encoding, &data).map(|_| ())
            }
            Record::Channel(channel) => {
                let (id, schema) = (channel.id, channel.schema_id);
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                self.mcap.add_channel_with_id(id, schema, topic, encoding, &channel.metadata).map(|_| ())
            }
            Record::Message { header, data } => {
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
            Record::Metadata(metadata) => self.mcap.write_metadata(&metadata),
            _ => Ok(()),
        }
    }
}
