//! No damaged frame is accepted and every undamaged one is, under any noise on the line.

use proptest::prelude::*;
use proptest::sample::Index;
use telemetry::{DecodeError, Decoder, Encoder, MAX_FRAME, Message};

use crate::values::{longest_messages, message};
use crate::{decode, encode};

#[derive(Debug, Clone)]
enum Damage {
    Flip(Index, u8),
    Cut(Index, usize),
    Insert(Index, Vec<u8>),
    Duplicate(Index, usize),
}

impl Damage {
    fn any() -> impl Strategy<Value = Self> {
        let noise = prop::collection::vec(prop_oneof![3 => any::<u8>(), 1 => Just(0)], 1..400);
        prop_oneof![
            (any::<Index>(), 0_u8..8).prop_map(|(at, bit)| Self::Flip(at, bit)),
            (any::<Index>(), 1_usize..300).prop_map(|(at, length)| Self::Cut(at, length)),
            (any::<Index>(), noise).prop_map(|(at, noise)| Self::Insert(at, noise)),
            (any::<Index>(), 1_usize..300).prop_map(|(at, length)| Self::Duplicate(at, length)),
        ]
    }

    fn apply(&self, line: &mut Vec<u8>) {
        let range = |at: &Index, length: usize| {
            let start = at.index(line.len());
            start..(start + length).min(line.len())
        };
        match self {
            Self::Flip(at, bit) => *at.get_mut(line) ^= 1 << bit,
            Self::Cut(at, length) => drop(line.drain(range(at, *length))),
            Self::Insert(at, noise) => drop(line.splice(range(at, 0), noise.iter().copied())),
            Self::Duplicate(at, length) => {
                let range = range(at, *length);
                let twice = line[range.clone()].to_vec();
                line.splice(range.start..range.start, twice);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn exactly_the_undamaged_frames_are_accepted(
        messages in prop::collection::vec(message(), 1..12),
        damage in prop::collection::vec(Damage::any(), 0..6),
    ) {
        let mut encoder = Encoder::new();
        let sent: Vec<_> = messages.iter().map(|message| (encode(&mut encoder, message), message)).collect();
        let mut line: Vec<u8> = sent.iter().flat_map(|(frame, _)| frame.clone()).collect();
        for damage in damage {
            if !line.is_empty() {
                damage.apply(&mut line);
            }
        }

        let expected: Vec<Option<&Message>> = line
            .split_inclusive(|&byte| byte == 0)
            .filter(|run| run.ends_with(&[0]) && run.len() > 1)
            .map(|run| sent.iter().find(|(frame, _)| frame == run).map(|(_, message)| *message))
            .collect();
        let mut decoder = Decoder::<Message>::new();
        let found = decode(&mut decoder, &line);
        let accepted: Vec<_> = found.iter().map(|payload| payload.as_ref().ok()).collect();
        prop_assert_eq!(&accepted, &expected);

        let whole = expected.iter().flatten().count();
        prop_assert_eq!(decoder.counts().received as usize, whole);
        prop_assert_eq!(decoder.counts().damaged as usize, expected.len() - whole);
    }

    #[test]
    fn a_frame_behind_noise_and_a_zero_is_accepted(
        noise in prop::collection::vec(any::<u8>(), 0..1000),
        message in message(),
    ) {
        let mut decoder = Decoder::<Message>::new();
        decode(&mut decoder, &noise);
        decode(&mut decoder, &[0]);
        prop_assert_eq!(decode(&mut decoder, &encode(&mut Encoder::new(), &message)), [Ok(message)]);
    }
}

#[test]
fn every_flipped_bit_is_noticed() {
    for message in longest_messages() {
        let frame = encode(&mut Encoder::new(), &message);
        for bit in 0..frame.len() * 8 {
            let mut damaged = frame.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            damaged.push(0);
            let found = decode(&mut Decoder::<Message>::new(), &damaged);
            assert!(
                !found.is_empty() && found.iter().all(|payload| *payload == Err(DecodeError::Damaged)),
                "bit {bit}"
            );
        }
    }
}

#[test]
fn an_endless_frame_is_one_error_and_the_next_is_accepted() {
    let mut decoder = Decoder::<Message>::new();
    assert_eq!(decode(&mut decoder, &[0x55; 10 * MAX_FRAME]), []);
    assert_eq!(decode(&mut decoder, &[0]), [Err(DecodeError::Oversize)]);
    let message = longest_messages()[0].clone();
    assert_eq!(decode(&mut decoder, &encode(&mut Encoder::new(), &message)), [Ok(message)]);
    assert_eq!(decoder.counts().damaged, 1);
}

#[test]
fn zeros_between_frames_are_nothing() {
    let mut decoder = Decoder::<Message>::new();
    assert_eq!(decode(&mut decoder, &[0; 10]), []);
    assert_eq!(decoder.counts().damaged, 0);
}
