//! Recordings: the MCAP reader, the recovery of damaged files, and the rows of recordings and of raw bytes.
//!
//! The first byte of an input selects its kind: an MCAP file as it is, messages of which one is made, or raw bytes.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Read};
use std::path::Path;

use mcap::WriteOptions;
use mcap::records::MessageHeader;
use proprio_session::recording::{Item, ReadError, Reader, recover, topics};
use proprio_session::{Header, RequiredColumns, Row, SessionError, SessionReader};
use telemetry::{MAX_SEGMENTS, PROTOCOL_VERSION};

use crate::frames::frame_of;
use crate::input_file::with_file;
use crate::parts::Parts;

/// Topics of the messages, by their channel.
const TOPICS: [&str; 5] = [topics::RAW, topics::HISTORY, topics::SAMPLES, topics::TRUTH, topics::MARKS];

/// Reads a recording or raw bytes.
///
/// # Panics
/// Where a file is not read in pieces as it is at once; where a recovered file is not whole, has other rows, or is recovered as
/// another one; and where the times of rows go backwards.
pub fn recording(bytes: &[u8]) {
    let mut parts = Parts::new(bytes);
    match parts.byte().map(|kind| kind % 3) {
        Some(0) => read_file(parts.rest()),
        Some(1) => read_file(&file_of(&mut parts)),
        Some(_) => drop(with_file(".bin", parts.rest(), rows)),
        None => {}
    }
}

fn read_file(file: &[u8]) {
    let at_once = items(Reader::new(file));
    assert_eq!(items(Reader::new(Piecewise(file))), at_once, "the items in pieces, and at once");
    let found = with_file(".mcap", file, rows);
    let Some(copy) = recovered(file) else { return };
    let read = with_file(".mcap", &copy, rows);
    if let (Ok(found), Ok(read)) = (&found, &read) {
        assert_eq!(
            read.iter().map(|row| &row.sample).collect::<Vec<_>>(),
            found.iter().map(|row| &row.sample).collect::<Vec<_>>(),
            "the rows of the copy"
        );
    }
    assert_eq!(recovered(&copy).as_deref(), Some(&copy[..]), "the copy of the copy");
}

/// The items to the end or to an error, and the error.
fn items(reader: impl Iterator<Item = Result<Item, ReadError>>) -> (Vec<Item>, Option<String>) {
    let mut items = Vec::new();
    for item in reader {
        match item {
            Ok(item) => items.push(item),
            Err(error) => return (items, Some(error.to_string())),
        }
    }
    (items, None)
}

/// The recovered file; `None` where the source is no recording.
fn recovered(file: &[u8]) -> Option<Vec<u8>> {
    let mut copy = Vec::new();
    let recovery = recover(Cursor::new(file), &mut copy).ok()?;
    assert!(recovery.bytes <= file.len() as u64 && recovery.times_ns.is_none_or(|(first, last)| first <= last));
    assert!((0.0..=1.0).contains(&recovery.kept()), "{recovery:?}");
    let mut again = Vec::new();
    let whole = recover(Cursor::new(&copy), &mut again).expect("it was written");
    assert!(!whole.has_loss() && !whole.was_cut && !whole.index_was_damaged, "{whole:?}");
    assert_eq!((whole.messages, whole.recorded), (recovery.messages, Some(recovery.messages)));
    Some(copy)
}

fn rows(path: &Path) -> Result<Vec<Row>, SessionError> {
    let segments = Header::of(path)?.segments.min(MAX_SEGMENTS);
    let mut reader = SessionReader::open(path, &RequiredColumns { bend: vec![None; segments], truth: false })?;
    let mut rows: Vec<Row> = Vec::new();
    while let Some(row) = reader.next_row()? {
        assert!(rows.last().is_none_or(|last| last.sample.time_us <= row.sample.time_us), "times go backwards");
        rows.push(row);
    }
    Ok(rows)
}

/// A recording of messages: their topic, the time since the one before, and the frame of a body or any bytes.
fn file_of(parts: &mut Parts) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut writer = WriteOptions::new().compression(None).create(&mut file).expect("memory takes it");
    let channels =
        TOPICS.map(|topic| writer.add_channel(0, topic, "", &BTreeMap::new()).expect("the topics are different"));
    let (mut log_time, mut sequence) = (0, 0);
    while let Some(kind) = parts.byte() {
        let topic = usize::from(kind) % TOPICS.len();
        log_time += u64::from(parts.byte().unwrap_or(0)) * 1_000_000;
        let mut bytes = parts.sized().to_vec();
        if topic < 2
            && let Some((topic, body)) = bytes.split_first()
        {
            bytes = frame_of(PROTOCOL_VERSION, *topic, body).unwrap_or_default();
        }
        let header = MessageHeader { channel_id: channels[topic], sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, &bytes).expect("memory takes it");
        sequence += 1;
    }
    writer.finish().expect("memory takes it");
    drop(writer);
    file.into_inner()
}

/// Gives few bytes at once.
struct Piecewise<'b>(&'b [u8]);

impl Read for Piecewise<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = buffer.len().min(self.0.len() % 7 + 1);
        self.0.read(&mut buffer[..count])
    }
}
