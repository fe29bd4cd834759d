//! Nothing loses a bit.

use proptest::prelude::*;
use telemetry::{Decoder, Encoder, Message, PROTOCOL_VERSION, Payload, Request};

use crate::values::{longest_messages, longest_request, message, request};
use crate::{decode, encode};

proptest! {
    #[test]
    fn every_message_arrives_as_it_was_sent(message in message()) {
        let frame = encode(&mut Encoder::new(), &message);
        prop_assert_eq!(decode(&mut Decoder::new(), &frame), [Ok(message)]);
    }

    #[test]
    fn every_request_arrives_as_it_was_sent(request in request()) {
        let frame = encode(&mut Encoder::new(), &request);
        prop_assert_eq!(decode(&mut Decoder::new(), &frame), [Ok(request)]);
    }

    #[test]
    fn any_body_is_refused_or_read_without_a_panic(version in 2_u8..=3, topic in 0_u8..12, body in prop::collection::vec(any::<u8>(), 0..250)) {
        if let Ok(message) = Message::read(version, topic, &body) {
            prop_assert_eq!(message.topic(), topic);
        }
        if let Ok(request) = Request::read(PROTOCOL_VERSION, topic | 0x80, &body) {
            prop_assert_eq!(request.topic(), topic | 0x80);
        }
    }
}

#[test]
fn extreme_values_arrive_as_they_were_sent() {
    for message in longest_messages() {
        let frame = encode(&mut Encoder::new(), &message);
        assert_eq!(decode(&mut Decoder::new(), &frame), [Ok(message)]);
    }
    let frame = encode(&mut Encoder::new(), &longest_request());
    assert_eq!(decode(&mut Decoder::new(), &frame), [Ok(longest_request())]);
}
