//! Noise on the line causes losses alone, which are counted.

use proprio_link::{Received, StreamDecoder};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use telemetry::{Encoder, MAX_FRAME, Message};

use super::line::{hello, sample};

const SAMPLES: u32 = 400;
const SEEDS: u64 = 200;

/// A Hello, and samples with a Hello now and then, frame by frame.
fn frames() -> (Vec<Message>, Vec<Vec<u8>>) {
    let mut messages = vec![Message::Hello(hello(1))];
    for tick in 0..SAMPLES {
        messages.push(Message::Sample(sample(tick)));
        messages.extend((tick % 100 == 99).then(|| Message::Hello(hello(1))));
    }
    encoded(messages)
}

/// A Hello and samples: no message is there twice.
fn distinct_frames() -> (Vec<Message>, Vec<Vec<u8>>) {
    encoded(
        [Message::Hello(hello(1))].into_iter().chain((0..SAMPLES).map(|tick| Message::Sample(sample(tick)))).collect(),
    )
}

fn encoded(messages: Vec<Message>) -> (Vec<Message>, Vec<Vec<u8>>) {
    let mut encoder = Encoder::new();
    let mut buffer = [0; MAX_FRAME];
    let frames = messages.iter().map(|message| encoder.encode(message, &mut buffer).expect("it fits").to_vec());
    let frames = frames.collect();
    (messages, frames)
}

struct Decoded {
    messages: Vec<Message>,
    decoder: StreamDecoder,
}

fn decode(bytes: &[u8]) -> Decoded {
    let (mut decoder, mut messages) = (StreamDecoder::new(None), Vec::new());
    decoder.open();
    for byte in bytes {
        decoder.push(*byte, |part| match part {
            Received::Message(message) => messages.push(message),
            Received::Undecoded(_) => {}
            other => panic!("one run of one board: {other:?}"),
        });
    }
    Decoded { messages, decoder }
}

fn below(random: &mut ChaCha8Rng, end: usize) -> usize {
    random.next_u32() as usize % end
}

/// Flips bits, cuts runs out and puts runs in again, anywhere but in the first and the last frame: there the counting
/// begins and ends.
fn disturb(frames: &[Vec<u8>], random: &mut ChaCha8Rng, kinds: usize) -> Vec<u8> {
    let (first, rest) = frames.split_first().expect("there are frames");
    let (last, middle) = rest.split_last().expect("there are several");
    let mut bytes = middle.concat();
    for _ in 0..10 {
        let at = below(random, bytes.len());
        let run = at..bytes.len().min(at + 1 + below(random, 300));
        match below(random, kinds) {
            0 => bytes[at] ^= 1 << below(random, 8),
            1 => drop(bytes.drain(run)),
            _ => {
                let copy = bytes[run.clone()].to_vec();
                bytes.splice(run.end..run.end, copy);
            }
        }
    }
    // A zero ends what the noise has left open, as the next frame but one would.
    [first.clone(), bytes, vec![0], last.clone()].concat()
}

#[test]
fn no_frame_is_accepted_that_was_not_sent() {
    let (messages, frames) = frames();
    for seed in 0..SEEDS {
        let decoded = decode(&disturb(&frames, &mut ChaCha8Rng::seed_from_u64(seed), 3));
        for message in &decoded.messages {
            assert!(messages.contains(message), "seed {seed}: {message:?}");
        }
        assert!(decoded.messages.len() > messages.len() / 2, "seed {seed}: most is decoded");
    }
}

#[test]
fn what_flips_and_cuts_destroy_is_counted_to_the_frame() {
    let (messages, frames) = frames();
    for seed in 0..SEEDS {
        let decoded = decode(&disturb(&frames, &mut ChaCha8Rng::seed_from_u64(seed), 2));
        let lost = messages.len() - decoded.messages.len();
        assert_eq!(decoded.decoder.counts().lost as usize, lost, "seed {seed}");
        assert_eq!(decoded.decoder.restarts(), 0);
    }
}

#[test]
fn pieces_that_come_twice_are_no_loss_and_hide_none() {
    let (messages, frames) = distinct_frames();
    for seed in 0..SEEDS {
        let decoded = decode(&disturb(&frames, &mut ChaCha8Rng::seed_from_u64(seed), 3));
        let arrived = decoded.messages.iter().map(|message| messages.iter().position(|sent| sent == message));
        // A frame that is destroyed, and whole in a piece that comes again later, was lost when it was due.
        let (mut next, mut in_order) = (0, 0);
        for place in arrived.map(|place| place.expect("it was sent")) {
            if place >= next {
                (next, in_order) = (place + 1, in_order + 1);
            }
        }
        assert_eq!(decoded.decoder.counts().lost as usize, messages.len() - in_order, "seed {seed}");
    }
}

#[test]
fn a_restart_is_reported_and_is_no_loss() {
    let (_, frames) = frames();
    let mut encoder = Encoder::new();
    let mut buffer = [0; MAX_FRAME];
    let mut bytes = frames[..200].concat();
    // The last frame was cut by the restart; a zero comes first.
    bytes.truncate(bytes.len() - 5);
    bytes.push(0);
    for message in [Message::Hello(hello(2)), Message::Sample(sample(0)), Message::Sample(sample(1))] {
        bytes.extend(encoder.encode(&message, &mut buffer).expect("it fits"));
    }
    let (mut decoder, mut restarts) = (StreamDecoder::new(None), 0);
    decoder.open();
    for byte in bytes {
        decoder.push(byte, |part| restarts += u32::from(part == Received::Restarted));
    }
    assert_eq!((restarts, decoder.restarts(), decoder.counts().lost, decoder.counts().damaged), (1, 1, 0, 1));
}

/// After a power cut boots are numbered from 1 again.
#[test]
fn a_restart_with_the_same_boot_number_is_detected_by_its_ticks() {
    let (_, frames) = frames();
    let mut encoder = Encoder::new();
    let mut buffer = [0; MAX_FRAME];
    let mut decoder = StreamDecoder::new(None);
    let mut restarts = 0;
    decoder.open();
    let first = frames[..200].concat();
    decoder.open();
    let mut take = |decoder: &mut StreamDecoder, bytes: &[u8]| {
        for byte in bytes {
            decoder.push(*byte, |part| restarts += u32::from(part == Received::Restarted));
        }
    };
    take(&mut decoder, &first);
    for message in [Message::Hello(hello(1)), Message::Sample(sample(0)), Message::Hello(hello(1))] {
        let frame = encoder.encode(&message, &mut buffer).expect("it fits").to_vec();
        take(&mut decoder, &frame);
    }
    assert_eq!((restarts, decoder.counts().lost), (1, 0));
}

/// The board ran when the line was opened, and was restarted by that: what is between the two runs is no loss.
#[test]
fn losses_count_from_the_first_hello_on() {
    let (_, frames) = frames();
    let mut encoder = Encoder::new();
    let mut buffer = [0; MAX_FRAME];
    // Numbers go back by more than half their range, which looks like a gap.
    for _ in 0..40_000 {
        let _ = encoder.encode(&Message::Sample(sample(9)), &mut buffer);
    }
    let late = encoder.encode(&Message::Sample(sample(9)), &mut buffer).expect("it fits").to_vec();
    let mut decoder = StreamDecoder::new(None);
    decoder.open();
    for byte in [late, frames[..50].concat()].concat() {
        decoder.push(byte, |_| {});
    }
    assert_eq!(decoder.counts().lost, 0);
}
