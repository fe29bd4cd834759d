//! Tests of recordings that are damaged, compressed or without the received bytes.

use std::io::Cursor;

use mcap::records::{Record, op};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use telemetry::{Encoder, MAX_FRAME, Message, Sample};

use super::form::{self, HEAD};
use super::read_error::ReadError;
use super::reader::{Item, Reader};
use super::recover::{RecoverError, Recovery, recover};
use super::rows::RecordedRows;
use super::summary::Summary;
use super::topics::RAW;
use super::writer::Recorder;
use crate::{HostNs, Row};

const START_NS: u64 = 1_764_000_000_000_000_000;

/// Samples of the recording: 20 s.
const SAMPLES: u32 = 200;

/// Time from one sample to the next, µs.
const STEP_US: u64 = 100_000;

fn recording() -> Vec<u8> {
    let mut recorder = Recorder::new(Vec::new(), HostNs(START_NS), "a test").expect("memory takes all");
    recorder.attach_table(HostNs(START_NS), &[b'#'; 2000]).expect("memory takes all");
    let (mut encoder, mut buffer) = (Encoder::new(), [0; MAX_FRAME]);
    for tick in 0..SAMPLES {
        let at = HostNs(START_NS + u64::from(tick) * STEP_US * 1000);
        let bend = [Some((tick % 4096) as u16); 12].into_iter().collect();
        let imu = [Some([16_384, tick as i16, 0, 0]); 6].into_iter().collect();
        let message = Message::Sample(Sample { tick, time_us: u64::from(tick) * STEP_US, tare_epoch: 0, bend, imu });
        let frame = encoder.encode(&message, &mut buffer).expect("it fits");
        recorder.bytes(at, frame).expect("memory takes all");
        recorder.message(at, &message).expect("memory takes all");
    }
    recorder.finish().expect("memory takes all")
}

fn items(bytes: &[u8]) -> Reader<Cursor<&[u8]>> {
    let mut source = Cursor::new(bytes);
    let summary = Summary::of(&mut source).expect("memory can be read");
    Reader::with_summary(source, summary)
}

/// The rows, and the number of holes.
fn rows(bytes: &[u8]) -> Result<(Vec<Row>, usize), ReadError> {
    let mut recorded = RecordedRows::new(items(bytes));
    let mut rows = Vec::new();
    while let Some(row) = recorded.next_row()? {
        rows.push(row);
    }
    Ok((rows, recorded.holes().len()))
}

fn recovered(bytes: &[u8]) -> Result<(Recovery, Vec<u8>), RecoverError> {
    let mut copy = Vec::new();
    let recovery = recover(Cursor::new(bytes), &mut copy)?;
    Ok((recovery, copy))
}

/// Places of the records of a file: opcode and begin.
fn records(bytes: &[u8]) -> Vec<(u8, usize)> {
    let mut at = mcap::MAGIC.len();
    let mut places = Vec::new();
    while let Some((opcode, length)) = form::head(&bytes[at..]).filter(|_| !bytes[at..].starts_with(mcap::MAGIC)) {
        places.push((opcode, at));
        at += HEAD + length as usize;
    }
    places
}

fn flipped(bytes: &[u8], at: usize, bit: usize) -> Vec<u8> {
    let mut damaged = bytes.to_vec();
    damaged[at] ^= 1 << (bit % 8);
    damaged
}

/// Requires that a damaged file loses no more than a chunk, whole or replayed, and that a loss is reported.
fn check(whole: &[Row], damaged: &[u8], place: &str) {
    let (recovery, copy) = recovered(damaged).unwrap_or_else(|error| panic!("{place}: {error}"));
    assert!(!recovery.was_cut, "{place}: cut");
    let (saved, holes) = rows(&copy).unwrap_or_else(|error| panic!("{place}: {error}"));
    assert_eq!(holes, 0, "{place}: holes in the copy");
    assert!(saved.len() * 100 >= whole.len() * 95, "{place}: {} rows", saved.len());
    assert!(recovery.has_loss() || saved.len() == whole.len(), "{place}: a loss in silence");
    assert!(recovery.holes.len() <= 1, "{place}: {:?}", recovery.holes);
    if damaged.starts_with(mcap::MAGIC) {
        let (replayed, _) = rows(damaged).unwrap_or_else(|error| panic!("{place}: {error}"));
        assert_eq!(replayed.len(), saved.len(), "{place}");
        for row in &replayed {
            let at = (row.sample.time_us / STEP_US) as usize;
            assert_eq!(row.sample, whole[at].sample, "{place}: a damaged sample");
        }
    }
}

#[test]
fn a_flipped_bit_in_any_record_loses_no_more_than_its_chunk() {
    let recording = recording();
    let (whole, _) = rows(&recording).expect("it is whole");
    assert_eq!(whole.len(), SAMPLES as usize);
    let records = records(&recording);
    for (i, (opcode, at)) in records.iter().enumerate() {
        // All of the head and of the begin, where the lengths and checksums are; each ninth record has all bits flipped.
        for byte in 0..60 {
            let bits = if i % 9 == 0 { 0..8 } else { byte + i..byte + i + 1 };
            for bit in bits.filter(|_| at + byte < recording.len()) {
                let place = format!("opcode {opcode} at {at}, byte {byte}, bit {}", bit % 8);
                check(&whole, &flipped(&recording, at + byte, bit), &place);
            }
        }
    }
}

#[test]
fn a_flipped_bit_at_random_loses_no_more_than_its_chunk() {
    let recording = recording();
    let (whole, _) = rows(&recording).expect("it is whole");
    let mut random = 1_u64;
    for _ in 0..300 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let (at, bit) = ((random >> 20) as usize % recording.len(), (random >> 60) as usize);
        check(&whole, &flipped(&recording, at, bit), &format!("byte {at}, bit {}", bit % 8));
    }
    for at in 0..400 {
        check(&whole, &flipped(&recording, at, at), &format!("byte {at}"));
        let at = recording.len() - 1 - at;
        check(&whole, &flipped(&recording, at, at), &format!("byte {at}"));
    }
}

#[test]
fn a_hole_has_the_times_of_its_neighbours() {
    let recording = recording();
    let chunks: Vec<usize> =
        records(&recording).into_iter().filter_map(|(opcode, at)| (opcode == op::CHUNK).then_some(at)).collect();
    let damaged = flipped(&recording, chunks[10] + 300, 3);
    let (recovery, _) = recovered(&damaged).expect("it is recovered");
    let [hole] = recovery.holes[..] else { panic!("{:?}", recovery.holes) };
    let times = hole.times(recovery.start_ns).to_string();
    let (from_s, to_s) = (
        (hole.from_ns.expect("it is in the middle") - START_NS) as f64 / 1e9,
        (hole.to_ns.expect("it is in the middle") - START_NS) as f64 / 1e9,
    );
    assert!(to_s - from_s > 0.5 && to_s - from_s < 1.1, "{from_s} to {to_s}");
    assert_eq!(times, format!("{from_s:.2} s to {to_s:.2} s is damaged and left out"));
    let (kept, holes) = rows(&damaged).expect("it is read");
    assert_eq!(holes, 1);
    let behind = kept.iter().find(|row| row.sample.time_us as f64 / 1e6 > from_s + 0.05).expect("rows follow");
    assert!(!behind.board.as_ref().expect("it is recorded").complete);
}

#[test]
fn the_channels_of_a_damaged_first_chunk_come_from_the_index() {
    let recording = recording();
    let (_, first) = records(&recording).into_iter().find(|(opcode, _)| *opcode == op::CHUNK).expect("it has chunks");
    let damaged = flipped(&recording, first + 200, 0);
    let (recovery, copy) = recovered(&damaged).expect("it is recovered");
    assert_eq!(recovery.lost_messages, 0);
    assert_eq!(recovery.holes.len(), 1);
    assert_eq!(recovery.holes[0].from_ns, None);
    assert!(rows(&copy).expect("it is whole").0.len() > 189);
}

/// The same recording with compressed chunks and without an index.
fn compressed(recording: &[u8], name: &str, compress: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    let mut put = |opcode: u8, body: &[u8]| {
        file.push(opcode);
        file.extend((body.len() as u64).to_le_bytes());
        file.extend(body);
    };
    for (opcode, at) in records(recording) {
        let (_, length) = form::head(&recording[at..]).expect("a record");
        let body = &recording[at + HEAD..][..length as usize];
        match mcap::parse_record(opcode, body).expect("it is whole") {
            Record::Chunk { data, .. } => {
                let data = compress(&data);
                let mut chunk = body[..28].to_vec();
                chunk.extend((name.len() as u32).to_le_bytes());
                chunk.extend(name.as_bytes());
                chunk.extend((data.len() as u64).to_le_bytes());
                chunk.extend(data);
                put(op::CHUNK, &chunk);
            }
            Record::Header(_) | Record::DataEnd(_) => put(opcode, body),
            _ => {}
        }
    }
    put(op::FOOTER, &[0; 20]);
    file.extend(mcap::MAGIC);
    file
}

fn zstd(data: &[u8]) -> Vec<u8> {
    compress_to_vec(data, CompressionLevel::Fastest)
}

fn lz4(data: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    std::io::Write::write_all(&mut encoder, data).expect("memory takes all");
    encoder.finish().expect("memory takes all")
}

#[test]
fn compressed_chunks_are_read_and_recovered() {
    let recording = recording();
    let (whole, _) = rows(&recording).expect("it is whole");
    for file in [compressed(&recording, "zstd", zstd), compressed(&recording, "lz4", lz4)] {
        assert!(file.len() < recording.len(), "{} bytes", file.len());
        assert_eq!(rows(&file).expect("it is whole").0, whole);
        let (recovery, copy) = recovered(&file).expect("it is whole");
        assert!(!recovery.has_loss() && !recovery.was_cut && !recovery.index_was_damaged, "{recovery:?}");
        assert_eq!(rows(&copy).expect("it is whole").0, whole);
    }
}

#[test]
fn a_flipped_bit_of_a_compressed_recording_loses_no_more_than_its_chunk() {
    let recording = recording();
    for file in [compressed(&recording, "zstd", zstd), compressed(&recording, "lz4", lz4)] {
        let second = records(&file).into_iter().filter(|(opcode, _)| *opcode == op::CHUNK).nth(1).expect("chunks").1;
        for at in (second..file.len()).step_by(3).chain(second..second + 120) {
            let (recovery, copy) =
                recovered(&flipped(&file, at, at / 3)).unwrap_or_else(|error| panic!("{at}: {error}"));
            let saved = rows(&copy).expect("it is whole").0.len();
            assert!(saved >= 190, "byte {at}: {saved}, {recovery:?}");
            assert!(recovery.has_loss() || saved == 200, "byte {at}: a loss in silence");
        }
        // Without an index, the channels of a damaged first chunk are lost.
        for at in mcap::MAGIC.len()..second {
            let _ = recovered(&flipped(&file, at, at));
        }
    }
}

/// A copy of some of a recording's topics.
fn with_topics(recording: &[u8], keeps: impl Fn(&str) -> bool) -> Vec<u8> {
    let mut copy = Vec::new();
    let mut writer = mcap::WriteOptions::new().compression(None).create(Cursor::new(&mut copy)).expect("memory");
    for message in mcap::MessageStream::new(recording).expect("it is whole") {
        let message = message.expect("it is whole");
        if keeps(&message.channel.topic) {
            writer.write(&message).expect("memory takes all");
        }
    }
    writer.finish().expect("memory takes all");
    drop(writer);
    copy
}

#[test]
fn a_recording_without_bytes_is_read_from_its_samples() {
    let recording = recording();
    let (whole, _) = rows(&recording).expect("it is whole");
    let (read, _) = rows(&with_topics(&recording, |topic| topic != RAW)).expect("it has samples");
    assert_eq!(read, whole);
}

#[test]
fn samples_of_a_recording_of_version_0_2_are_read_without_its_bytes() {
    let recording = include_bytes!("../../../../host-tests/recordings/earlier-schema-hash.mcap");
    let readings = |recording: &[u8]| {
        let rows = rows(recording).expect("it is whole").0.into_iter();
        rows.map(|row| row.sample).collect::<Vec<_>>()
    };
    let whole = readings(recording);
    assert_eq!(whole.len(), 300);
    assert_eq!(readings(&with_topics(recording, |topic| topic != RAW)), whole);
}

#[test]
fn a_foreign_file_is_refused_with_its_topics() {
    let foreign = with_topics(&recording(), |_| false);
    let error = rows(&foreign).expect_err("it has no samples").to_string();
    assert!(error.contains("/proprio/raw and /proprio/samples are missing"), "{error}");
    let mut copy = Vec::new();
    let mut writer = mcap::WriteOptions::new().compression(None).create(Cursor::new(&mut copy)).expect("memory");
    for topic in ["/tf", "/camera"] {
        let id = writer.add_channel(0, topic, "json", &std::collections::BTreeMap::new()).expect("memory takes all");
        let header = mcap::records::MessageHeader { channel_id: id, sequence: 0, log_time: 1, publish_time: 1 };
        writer.write_to_known_channel(&header, b"{}").expect("memory takes all");
    }
    writer.finish().expect("memory takes all");
    drop(writer);
    let error = rows(&copy).expect_err("it has no samples").to_string();
    assert!(error.contains("it has /camera, /tf"), "{error}");
}

#[test]
fn any_bytes_behind_the_magic_ones_are_refused_without_a_panic() {
    let recording = recording();
    let mut random = 1_u64;
    let mut next = move || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize
    };
    for _ in 0..60 {
        let mut damaged = recording.clone();
        for _ in 0..=next() % 200 {
            let at = mcap::MAGIC.len() + next() % (damaged.len() - mcap::MAGIC.len());
            damaged[at] = next() as u8;
        }
        damaged.truncate(next() % damaged.len());
        let _ = recovered(&damaged);
        let _ = items(&damaged).filter(|item| matches!(item, Ok(Item::Hole(_)))).count();
    }
}

#[test]
fn a_file_that_is_cut_at_any_byte_has_no_hole_and_loses_its_end() {
    let recording = recording();
    // The footer of 20 bytes before the last magic bytes begins with the place of the index.
    let footer = recording.len() - mcap::MAGIC.len() - 20;
    let index = u64::from_le_bytes(*recording[footer..].first_chunk().expect("it has eight bytes")) as usize;
    for end in (4096..recording.len()).step_by(7) {
        let (recovery, _) = recovered(&recording[..end]).unwrap_or_else(|error| panic!("cut at {end}: {error}"));
        assert!(recovery.was_cut && !recovery.is_damaged(), "cut at {end}: {recovery:?}");
        assert_eq!(recovery.has_loss(), end < index, "cut at {end}, the index begins at {index}: {recovery:?}");
    }
}

/// The channels' records are in the first chunk and in the index alone.
#[test]
fn a_cut_file_whose_first_chunk_is_damaged_loses_that_chunk_and_its_end() {
    let recording = recording();
    let records = records(&recording);
    let chunks: Vec<usize> = records.iter().filter(|(opcode, _)| *opcode == op::CHUNK).map(|(_, at)| *at).collect();
    let last = *chunks.last().expect("chunks");
    let damaged = flipped(&recording[..last], chunks[0] + 200, 3);
    let (recovery, copy) = recovered(&damaged).expect("chunks are whole");
    assert!(recovery.was_cut && recovery.holes.len() == 1 && recovery.lost_messages == 0, "{recovery:?}");
    let (saved, _) = rows(&copy).expect("the copy is whole");
    // The table ends the first chunk, which has the channels alone; the others have 9 samples of 0.1 s, the last one 2 of the 200.
    assert_eq!(saved.len(), 198);
    for row in &saved {
        assert_eq!(u64::from(row.board.as_ref().expect("a board's").tick) * STEP_US, row.sample.time_us);
    }
}

/// Numbers of another program's channels mean other topics.
#[test]
fn the_channels_of_another_program_are_not_supposed() {
    let recording = recording();
    let records = records(&recording);
    let metadata = records.iter().find(|(opcode, _)| *opcode == op::METADATA).expect("metadata").1;
    let chunks: Vec<usize> = records.iter().filter(|(opcode, _)| *opcode == op::CHUNK).map(|(_, at)| *at).collect();
    let mut foreign = flipped(&recording[..*chunks.last().expect("chunks")], chunks[0] + 200, 3);
    // The name of its metadata, behind the length of the name.
    foreign[metadata + HEAD + 4..metadata + HEAD + 11].copy_from_slice(b"another");
    let (recovery, _) = recovered(&foreign).expect("chunks are whole");
    assert_eq!(recovery.messages, 0);
    assert!(recovery.lost_messages > 300, "{recovery:?}");
}
