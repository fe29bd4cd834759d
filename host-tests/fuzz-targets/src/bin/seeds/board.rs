//! Seeds of what a board sends, receives and stores.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;

use calibration_tables::ArmFile;
use proprio_link::table::StoredTable;
use telemetry::{
    Command, Decoder, Encoder, MAX_FRAME, Message, PROTOCOL_VERSION, Payload, Rates, Request, SetPressures,
    TABLE_CHUNK_BYTES, TableAnnouncement, TableChunk, TareMode, vector,
};

use crate::seed::{Seed, TABLES, root, seed, text_of};

/// First byte of received bytes in the inputs of `frame_decoder`.
const STREAM: u8 = 0xFF;

/// Seeds of each kind of message.
const EACH: usize = 2;

/// The session of the board in `requests` after its first ping.
const SESSION: u16 = 0x101;

/// Body of a payload.
fn body<P: Payload>(payload: &P) -> Vec<u8> {
    let mut body = [0; MAX_FRAME];
    let length = payload.write(PROTOCOL_VERSION, &mut body).expect("every payload fits");
    body[..length].to_vec()
}

/// Frames and bodies of a recorded stream, and of every request.
pub fn frames() -> Result<Vec<Seed>, Box<dyn Error>> {
    let stream = fs::read(root().join("telemetry/examples/stream.bin"))?;
    let (mut seeds, mut seen) = (Vec::new(), BTreeMap::<u8, usize>::new());
    let mut decoder = Decoder::<Message>::new();
    for frame in stream.split_inclusive(|byte| *byte == 0) {
        let Some(Ok(message)) = frame.iter().find_map(|byte| decoder.push(*byte)) else { continue };
        let count = seen.entry(message.topic()).or_default();
        *count += 1;
        if *count <= EACH {
            let name = format!("topic-{}-{count}", message.topic());
            seeds.push(seed(format!("{name}-body"), message.topic(), &body(&message)));
            seeds.push(seed(format!("{name}-frame"), STREAM, frame));
        }
    }
    seeds.push(seed("stream", STREAM, &stream[..600]));
    seeds.push(seed("stream-from-its-middle", STREAM, &stream[1000..1400]));
    let mut encoder = Encoder::new();
    for (name, command) in commands() {
        let request = Request { id: 7, session: SESSION, command };
        seeds.push(seed(format!("request-{name}-body"), request.topic(), &body(&request)));
        let mut buffer = [0; MAX_FRAME];
        let frame = encoder.encode(&request, &mut buffer)?;
        seeds.push(seed(format!("request-{name}-frame"), STREAM, frame));
        if name == "ping" {
            seeds.push(seed("flipped-bits", STREAM, &flipped(frame)));
        }
    }
    Ok(seeds)
}

/// A frame with each of its bits flipped in turn.
fn flipped(frame: &[u8]) -> Vec<u8> {
    let mut stream = Vec::new();
    for bit in 0..8 * (frame.len() - 1) {
        stream.extend(frame);
        let at = stream.len() - frame.len() + bit / 8;
        stream[at] ^= 1 << (bit % 8);
    }
    stream
}

/// Commands of every kind.
fn commands() -> Vec<(&'static str, Command)> {
    let pressures = SetPressures { pressures_pa: vector([40_000, 0, 280_000, 1, 2, 3]), valid_ms: 200 };
    let piece = TableChunk { offset: 0, bytes: vector(*b"image") };
    vec![
        ("ping", Command::Ping),
        ("tare", Command::Tare(TareMode::IfStill)),
        ("rates", Command::Rates(Rates { sample: 1, estimate: 2, health: 25, uncertainty: 0 })),
        ("arm", Command::Arm),
        ("set", Command::SetPressures(pressures)),
        ("disarm", Command::Disarm),
        ("table-begin", Command::TableBegin(TableAnnouncement { image_bytes: 5, source_bytes: 0, crc: 1 })),
        ("table-write", Command::TableWrite(piece)),
        ("table-commit", Command::TableCommit),
        ("table-read", Command::TableRead(3)),
        ("table-erase", Command::TableErase),
        ("reboot", Command::Reboot),
    ]
}

/// Each command in a session of its own, armed for set-points; commands under one number and under lower ones; a session in
/// which the arm is driven; frames as bytes; and a flood.
pub fn requests() -> Vec<Seed> {
    let part = |id: u32, command: &Command| {
        let request = body(&Request { id, session: SESSION, command: command.clone() });
        [&[1, request.len() as u8], &request[..]].concat()
    };
    let ticks = |count: u8| vec![2, count];
    let (ping, arm) = (part(1, &Command::Ping), part(2, &Command::Arm));
    let mut seeds = Vec::new();
    for (name, command) in commands() {
        seeds.push((name.to_owned(), [&ping[..], &arm, &part(3, &command), &ticks(5), &[3], &ticks(200)].concat()));
    }
    let commands = commands();
    let same_number =
        commands.iter().flat_map(|(_, command)| [part(3, command), ticks(5)]).collect::<Vec<_>>().concat();
    seeds.push(("same-number".to_owned(), [&ping[..], &arm, &same_number].concat()));
    let other = Request { id: 3, session: SESSION + 1, command: Command::Reboot };
    let other = [&[1, body(&other).len() as u8], &body(&other)[..]].concat();
    seeds.push(("other-session".to_owned(), [&ping[..], &arm, &other].concat()));
    let lower = (1..9).rev().map(|id| part(id, &Command::Arm)).collect::<Vec<_>>().concat();
    seeds.push(("lower-numbers".to_owned(), [&ping[..], &lower].concat()));
    let set = &commands.iter().find(|(name, _)| *name == "set").expect("it is in the list").1;
    let mut drive = [ping.clone(), arm.clone()].concat();
    for id in 3..12 {
        drive.extend([part(id, set), ticks(4), vec![3]].concat());
    }
    drive.extend([ticks(120), part(12, &Command::Disarm), part(13, set)].concat());
    seeds.push(("drive".to_owned(), drive));
    let mut buffer = [0; MAX_FRAME];
    let request = Request { id: 1, session: 0, command: Command::Ping };
    let frame = Encoder::new().encode(&request, &mut buffer).expect("it fits");
    seeds.push(("bytes".to_owned(), [&[0, frame.len() as u8], frame, &[0, 3, 5, 0, 9], frame].concat()));
    let flood = (1..40).map(|id| part(id, &Command::Ping)).collect::<Vec<_>>().concat();
    seeds.push(("flood".to_owned(), [flood, part(40, &Command::Disarm)].concat()));
    seeds
}

/// Images of tables, slots with them, and transfers.
pub fn tables() -> Result<Vec<Seed>, Box<dyn Error>> {
    let mut seeds = Vec::new();
    for (name, path) in TABLES {
        let (text, mut file) = (text_of(path)?, ArmFile::parse(&text_of(path)?)?);
        let whole = StoredTable::new(&file, text.as_bytes())?;
        file.segments.truncate(1);
        (file.board, file.tuning) = (None, None);
        let short = StoredTable::new(&file, file.to_toml().as_bytes())?;
        for (name, stored) in [(name.to_owned(), whole), (format!("{name}-one-segment"), short)] {
            seeds.push(seed(format!("{name}-image"), 0, &stored.image));
            if name.ends_with("segment") {
                let lengths = [7, stored.image.len() as u32, stored.source.len() as u32].map(u32::to_le_bytes).concat();
                seeds.push(seed(format!("{name}-slot"), 1, &[&[3], &lengths[..], &stored.body()].concat()));
                seeds.push((format!("{name}-transfer"), transfer(&stored, false)));
                seeds.push((format!("{name}-wrong-checksum"), transfer(&stored, true)));
            }
        }
    }
    Ok(seeds)
}

/// The transfer of a table in pieces, with a right checksum or a wrong one, and its erasure.
fn transfer(stored: &StoredTable, is_wrong: bool) -> Vec<u8> {
    let body = stored.body();
    let mut parts = vec![2, if is_wrong { 0x80 } else { 0 }];
    parts.extend([stored.image.len(), body.len()].map(|length| (length as u32).to_le_bytes()).as_flattened());
    parts.extend(&body);
    for _ in body.chunks(TABLE_CHUNK_BYTES) {
        parts.extend([2, TABLE_CHUNK_BYTES as u8]);
    }
    parts.extend([3, 0x83]);
    parts
}
