//! Seeds of recordings: the begin of the repository's recordings, damaged ones, messages, and raw bytes.

use std::error::Error;
use std::fs;
use std::io::Cursor;

use proprio_session::recording::{Item, Reader, Recorder, recover};
use proprio_session::{HostNs, Truth};
use telemetry::{Decoder, Message};

use crate::seed::{Seed, root, seed};

/// Kinds of an input.
const FILE: u8 = 0;
const MESSAGES: u8 = 1;
const RAW: u8 = 2;

/// Received bytes of a seed.
const BYTES: usize = 1500;

/// Recordings of version 0.1 and of an earlier schema hash, cut to their begin, and damaged.
pub fn recordings() -> Result<Vec<Seed>, Box<dyn Error>> {
    let mut seeds = Vec::new();
    for name in ["version-0.1-anchor", "version-0.1-observer", "earlier-schema-hash"] {
        let file = fs::read(root().join(format!("host-tests/recordings/{name}.mcap")))?;
        let short = begin(&file)?;
        let mut copy = Vec::new();
        recover(Cursor::new(&short), &mut copy)?;
        seeds.push(seed(format!("{name}-copy"), FILE, &copy));
        seeds.push(seed(format!("{name}-cut"), FILE, &short[..short.len() / 2]));
        let mut damaged = short.clone();
        damaged[short.len() / 3] ^= 4;
        seeds.push(seed(format!("{name}-damaged"), FILE, &damaged));
        seeds.push(seed(name, FILE, &short));
    }
    let stream = fs::read(root().join("telemetry/examples/stream.bin"))?;
    seeds.push(seed("stream", RAW, &stream[..BYTES]));
    seeds.push(seed("stream-from-its-middle", RAW, &stream[1000..1000 + BYTES]));
    seeds.push(seed("messages", MESSAGES, &messages(&stream[..BYTES])));
    Ok(seeds)
}

/// The begin of a recording, with a truth and a mark.
fn begin(file: &[u8]) -> Result<Vec<u8>, Box<dyn Error>> {
    let (mut recorder, mut decoder) = (Recorder::new(Vec::new(), HostNs(0), "seeds")?, Decoder::<Message>::new());
    let mut length = 0;
    for item in Reader::new(file) {
        let Item::Bytes(at, bytes) = item? else { continue };
        recorder.bytes(at, &bytes)?;
        for message in bytes.iter().filter_map(|byte| decoder.push(*byte)?.ok()) {
            recorder.message(at, &message)?;
            if let Message::Sample(sample) = &message {
                recorder.truth(at, sample.tick, &[Some(Truth { x_m: 0.1, y_m: 0.2, heading_rad: Some(0.3) }); 6])?;
            }
        }
        length += bytes.len();
        if length > BYTES {
            recorder.mark(at, "a mark")?;
            break;
        }
    }
    Ok(recorder.finish()?)
}

/// Messages of the frames of a stream: topic, time since the one before, and body; and a mark.
fn messages(stream: &[u8]) -> Vec<u8> {
    let mut parts = Vec::new();
    for frame in stream.split(|byte| *byte == 0) {
        let mut content = [0; 256];
        let Ok(report) = cobs::decode(frame, &mut content) else { continue };
        let content = &content[..report.frame_size()];
        let Some((body, _)) = content.split_at_checked(content.len().saturating_sub(4)) else { continue };
        if let [_, topic, _, _, body @ ..] = body {
            parts.extend([0, 10, body.len() as u8 + 1, *topic]);
            parts.extend(body);
        }
    }
    parts.extend([4, 1, 9, 0, 1, 0, 0, 2, 0, 0, 0]);
    parts.extend(b"m\0");
    parts
}
