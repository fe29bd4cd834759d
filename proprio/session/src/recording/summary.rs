//! The index at a file's end: it repeats the channels, which a damaged first chunk would take along.

use std::collections::BTreeMap;
use std::io::{self, Read, Seek, SeekFrom};

use mcap::records::{Channel, Record, SchemaHeader, Statistics, op};

use super::form::{self, HEAD, u32_at, u64_at};

/// Longest index that is read, bytes.
const MOST: u64 = 1 << 28;

/// Length of the footer and the magic bytes, bytes.
const END: usize = HEAD + 20 + mcap::MAGIC.len();

/// The parts of a file's index that a damaged data section needs.
#[derive(Debug, Default)]
pub struct Summary {
    pub schemas: BTreeMap<u16, (SchemaHeader, Vec<u8>)>,
    pub channels: BTreeMap<u16, Channel>,
    pub statistics: Option<Statistics>,
}

impl Summary {
    /// Reads the index of a file and goes back to its begin. A damaged index, and that of a pipe, is empty.
    pub fn of(file: &mut (impl Read + Seek)) -> io::Result<Self> {
        if file.seek(SeekFrom::End(0)).is_err() {
            return Ok(Self::default());
        }
        let index = index(file)?;
        file.rewind()?;
        Ok(index.map(|index| Self::new(&index)).unwrap_or_default())
    }

    fn new(index: &[u8]) -> Self {
        let mut summary = Self::default();
        let mut rest = index;
        while let Some((opcode, body, behind)) = form::split_record(rest) {
            rest = behind;
            if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::STATISTICS) {
                continue;
            }
            match mcap::parse_record(opcode, body) {
                Ok(Record::Schema { header, data }) => {
                    summary.schemas.insert(header.id, (header, data.into_owned()));
                }
                Ok(Record::Channel(channel)) => {
                    summary.channels.insert(channel.id, channel);
                }
                Ok(Record::Statistics(statistics)) => summary.statistics = Some(statistics),
                _ => {}
            }
        }
        summary
    }
}

/// The bytes of the index, if its checksum holds.
fn index(file: &mut (impl Read + Seek)) -> io::Result<Option<Vec<u8>>> {
    let size = file.seek(SeekFrom::End(0))?;
    let Some(end) = size.checked_sub(END as u64) else { return Ok(None) };
    file.seek(SeekFrom::Start(end))?;
    let mut footer = [0; END];
    file.read_exact(&mut footer)?;
    let (start, crc) = (u64_at(&footer, HEAD), u32_at(&footer, HEAD + 16).filter(|crc| *crc != 0));
    let (Some(start), Some(crc)) = (start, crc) else { return Ok(None) };
    if form::head(&footer) != Some((op::FOOTER, 20)) || start > end || end - start > MOST {
        return Ok(None);
    }
    file.seek(SeekFrom::Start(start))?;
    let mut index = Vec::new();
    file.take(end - start).read_to_end(&mut index)?;
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&index);
    hasher.update(&footer[..HEAD + 16]);
    Ok((hasher.finalize() == crc).then_some(index))
}
