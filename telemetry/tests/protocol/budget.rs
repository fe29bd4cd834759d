//! The line carries it all, with a fifth of it free.

use proptest::prelude::*;
use telemetry::{
    DecodeError, Decoder, EncodeError, Encoder, FrameLengths, MAX_FRAME, MAX_REGULATORS, MAX_SEGMENTS, Message,
    Payload, Rates,
};

use crate::values::{longest_messages, longest_messages_of, longest_request, message, request};
use crate::{decode, encode};

/// Length of the longest frame of the message's kind for an arm of six segments and six regulators.
fn longest_frame(message: &Message) -> usize {
    match message {
        Message::Hello(_) => 199,
        Message::Sample(_) => 97,
        Message::Estimate(_) => 88,
        Message::Event(_) => 17,
        Message::Reply(_) => 20,
        Message::Uncertainty(_) => 120,
        Message::Table(_) => 36,
        Message::Health(_) | Message::TableData(_) => 177,
        Message::Tare(_) => 29,
    }
}

#[test]
fn frames_are_as_long_as_the_protocol_page_says() {
    for message in longest_messages_of(6, 6) {
        assert_eq!(encode(&mut Encoder::new(), &message).len(), longest_frame(&message), "{message:?}");
    }
    assert_eq!(encode(&mut Encoder::new(), &longest_request()).len(), 186);
}

#[test]
fn frames_of_every_arm_are_as_long_as_its_budget_says() {
    for (segments, regulators) in (0..=MAX_SEGMENTS).flat_map(|n| [(n, 0), (n, 5), (n, MAX_REGULATORS)]) {
        let lengths = FrameLengths::of(segments, regulators);
        for message in longest_messages_of(segments, regulators) {
            let expected = match message {
                Message::Hello(_) => lengths.hello,
                Message::Sample(_) => lengths.sample,
                Message::Estimate(_) => lengths.estimate,
                Message::Health(_) => lengths.health,
                Message::Uncertainty(_) => lengths.uncertainty,
                _ => continue,
            };
            assert_eq!(encode(&mut Encoder::new(), &message).len(), expected as usize, "{segments}: {message:?}");
        }
    }
}

#[test]
fn the_stream_of_every_arm_leaves_a_fifth_of_the_line_free_at_worst() {
    for (segments, regulators) in (1..=MAX_SEGMENTS).flat_map(|n| [(n, 0), (n, MAX_REGULATORS)]) {
        let bytes = FrameLengths::of(segments, regulators).bytes_per_second(Rates::of_arm(segments, regulators));
        assert!(bytes <= 20_000, "{segments} segments: {bytes} bytes a second");
    }
}

#[test]
fn estimates_of_up_to_six_segments_are_sent_every_tick_and_of_more_every_second_one() {
    let periods: Vec<u16> = (1..=MAX_SEGMENTS).map(|segments| Rates::of_arm(segments, 6).estimate).collect();
    assert_eq!(periods, [1, 1, 1, 1, 1, 1, 2, 2]);
    assert!((1..=MAX_SEGMENTS).all(|segments| Rates::of_arm(segments, 6).sample == 1));
}

#[test]
fn the_buffer_says_when_it_is_too_short_and_no_number_is_used_up() {
    for message in longest_messages() {
        let mut encoder = Encoder::new();
        let frame = encode(&mut Encoder::new(), &message);
        for room in 0..frame.len() {
            assert_eq!(encoder.encode(&message, &mut [0; MAX_FRAME][..room]), Err(EncodeError::Room));
        }
        let mut exact = vec![0xAA; frame.len()];
        assert_eq!(encoder.encode(&message, &mut exact), Ok(&frame[..]));
    }
}

/// A message of a later version, with a body of this length.
struct Later(usize);

impl Payload for Later {
    const VERSIONS: &'static [u8] = &[3];

    fn topic(&self) -> u8 {
        11
    }

    fn write(&self, _: u8, body: &mut [u8]) -> Option<usize> {
        body.get_mut(..self.0)?.fill(0xAA);
        Some(self.0)
    }

    fn read(_: u8, topic: u8, _: &[u8]) -> Result<Self, DecodeError> {
        Err(DecodeError::Topic(topic))
    }
}

#[test]
fn the_longest_frame_arrives_and_a_longer_one_is_refused() {
    let frame = encode(&mut Encoder::new(), &Later(245));
    assert_eq!(frame.len(), MAX_FRAME);
    assert_eq!(decode(&mut Decoder::<Message>::new(), &frame), [Err(DecodeError::Topic(11))]);
    assert_eq!(Encoder::new().encode(&Later(246), &mut [0; 2 * MAX_FRAME]), Err(EncodeError::Room));
}

proptest! {
    #[test]
    fn no_message_is_longer_than_the_longest(message in message(), request in request()) {
        let longest = longest_messages().into_iter().find(|longest| longest.topic() == message.topic());
        let longest = longest.map(|longest| encode(&mut Encoder::new(), &longest).len());
        prop_assert!(Some(encode(&mut Encoder::new(), &message).len()) <= longest);
        let longest_request = encode(&mut Encoder::new(), &longest_request());
        prop_assert!(encode(&mut Encoder::new(), &request).len() <= longest_request.len());
    }
}
