//! The line carries it all, with a fifth to spare.

use proptest::prelude::*;
use telemetry::{DecodeError, Decoder, EncodeError, Encoder, MAX_FRAME, Message, Payload};

use crate::values::{longest_messages, longest_request, message, request};
use crate::{decode, encode};

/// 250 000 Bd; a byte takes ten bits with its start and stop bit.
const LINE_BYTES_PER_SECOND: usize = 25_000;

/// Length of the longest frame of the message's kind.
fn longest_frame(message: &Message) -> usize {
    match message {
        Message::Hello(_) => 208,
        Message::Sample(_) => 98,
        Message::Estimate(_) => 87,
        Message::Health(_) => 161,
        Message::Event(_) => 22,
        Message::Reply(_) => 17,
        Message::Uncertainty(_) => 119,
        Message::Table(_) => 36,
        Message::TableData(_) => 177,
    }
}

#[test]
fn frames_are_as_long_as_the_protocol_page_says() {
    for message in longest_messages() {
        assert_eq!(encode(&mut Encoder::new(), &message).len(), longest_frame(&message), "{message:?}");
    }
    assert_eq!(encode(&mut Encoder::new(), &longest_request()).len(), 183);
}

#[test]
fn the_stream_leaves_a_fifth_of_the_line_free_at_worst() {
    let bytes_per_second: usize = longest_messages()
        .iter()
        .map(|message| {
            let per_second = match message {
                Message::Sample(_) | Message::Estimate(_) => 100,
                Message::Health(_) => 5,
                Message::Uncertainty(_) => 4,
                Message::Hello(_) => 1,
                Message::Event(_) | Message::Reply(_) | Message::Table(_) | Message::TableData(_) => 0,
            };
            per_second * encode(&mut Encoder::new(), message).len()
        })
        .sum();
    assert!(bytes_per_second <= LINE_BYTES_PER_SECOND * 4 / 5, "{bytes_per_second} bytes a second");
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
    fn topic(&self) -> u8 {
        10
    }

    fn write(&self, body: &mut [u8]) -> Option<usize> {
        body.get_mut(..self.0)?.fill(0xAA);
        Some(self.0)
    }

    fn read(topic: u8, _: &[u8]) -> Result<Self, DecodeError> {
        Err(DecodeError::Topic(topic))
    }
}

#[test]
fn the_longest_frame_arrives_and_a_longer_one_is_refused() {
    let frame = encode(&mut Encoder::new(), &Later(245));
    assert_eq!(frame.len(), MAX_FRAME);
    assert_eq!(decode(&mut Decoder::<Message>::new(), &frame), [Err(DecodeError::Topic(10))]);
    assert_eq!(Encoder::new().encode(&Later(246), &mut [0; 2 * MAX_FRAME]), Err(EncodeError::Room));
}

proptest! {
    #[test]
    fn no_message_is_longer_than_the_longest(message in message(), request in request()) {
        prop_assert!(encode(&mut Encoder::new(), &message).len() <= longest_frame(&message));
        prop_assert!(encode(&mut Encoder::new(), &request).len() <= 183);
    }
}
