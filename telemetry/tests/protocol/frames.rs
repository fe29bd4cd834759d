//! Frames have the bytes of the protocol page, and no others are accepted.

use proptest::prelude::*;
use telemetry::{
    DecodeError, Decoder, EARLIER_SCHEMAS, Encoder, Event, Message, PROTOCOL_VERSION, Payload, Request, SCHEMA,
    SegmentUncertainty, SensorState, Uncertainty, topic,
};

use crate::values::{longest_messages, many, message, ping};
use crate::{block_by_hand, decode, encode, frame_by_hand};

proptest! {
    #[test]
    fn a_frame_is_standard_cobs_and_crc_32(message in message()) {
        let mut body = [0; 250];
        let length = message.write(PROTOCOL_VERSION, &mut body).expect("a body has at most 245 bytes");
        let by_hand = frame_by_hand(PROTOCOL_VERSION, message.topic(), 0, &body[..length]);
        prop_assert_eq!(encode(&mut Encoder::new(), &message), by_hand);
    }
}

#[test]
fn topics_are_those_of_the_protocol_page() {
    assert_eq!(longest_messages().map(|message| message.topic()), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    assert_eq!(ping(1).topic(), 0x80);
}

#[test]
fn the_schema_is_that_of_this_version_and_of_the_protocol_page() {
    // If this fails, the layout of a message has changed. A new message or command at the end: add the hash before to
    // EARLIER_SCHEMAS. Any other change: raise PROTOCOL_VERSION, and keep a reader of the version before. In both cases put
    // the new hash here, and bring docs/reference/protocol.md up to date.
    assert_eq!((PROTOCOL_VERSION, SCHEMA), (3, 0x37D5_3C1D));
    let page = include_str!("../../../docs/reference/protocol.md");
    assert!(page.contains(&format!("`0x{SCHEMA:08x}`")));
    assert!(EARLIER_SCHEMAS.iter().all(|schema| page.contains(&format!("`0x{schema:08x}`"))));
}

/// The body that a message has on the line.
fn body(message: &Message) -> Vec<u8> {
    let mut body = [0; 250];
    let length = message.write(PROTOCOL_VERSION, &mut body).expect("a body has at most 245 bytes");
    body[..length].to_vec()
}

#[test]
fn every_byte_of_an_uncertainty_has_its_place() {
    let mut segments: heapless::Vec<_, 8> = many(6, SegmentUncertainty::default());
    segments[0] = SegmentUncertainty {
        theta: Some(0x0403_0201),
        end: Some([0x0807_0605, -2, 0x100F_0E0D]),
        contact_percent: 250,
        in_contact: true,
    };
    segments[4] = SegmentUncertainty { theta: Some(1), end: None, contact_percent: 7, in_contact: false };
    segments[5].in_contact = true;
    let found = body(&Message::Uncertainty(Uncertainty { tick: 0xA3A2_A1A0, segments }));

    let mut expected = [0; 110];
    expected[..8].copy_from_slice(&[0xA0, 0xA1, 0xA2, 0xA3, 0b01_0001, 0b00_0001, 0b10_0001, 6]);
    let first = [250, 1, 2, 3, 4, 5, 6, 7, 8, 0xFE, 0xFF, 0xFF, 0xFF, 0x0D, 0x0E, 0x0F, 0x10];
    expected[8..25].copy_from_slice(&first);
    expected[8 + 4 * 17..][..2].copy_from_slice(&[7, 1]);
    assert_eq!(found, expected);
}

#[test]
fn a_contact_names_the_tick_and_each_segment() {
    let contact = Event::Contact(300, 0b110);
    assert_eq!(body(&Message::Event(contact)), [5, 0xac, 0x02, 0b110]);
}

#[test]
fn a_frame_of_another_version_is_told_apart_from_a_damaged_one() {
    let mut decoder = Decoder::<Message>::new();
    let found = decode(&mut decoder, &frame_by_hand(PROTOCOL_VERSION + 1, topic::EVENT, 0, &[3]));
    assert_eq!(found, [Err(DecodeError::Version(PROTOCOL_VERSION + 1))]);
    assert_eq!((decoder.counts().wrong_version, decoder.counts().damaged), (1, 0));
}

/// Found by fuzzing: the fuzz target's reference decoder classified each frame shorter than a header as damaged.
#[test]
fn a_frame_of_another_version_may_be_shorter_than_a_header_of_this_one() {
    let with_crc = |content: &[u8]| {
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(content);
        block_by_hand(&[content, &crc.to_le_bytes()].concat())
    };
    let result = |content: &[u8]| decode(&mut Decoder::<Message>::new(), &with_crc(content));
    assert_eq!(result(&[0, 0, 0]), [Err(DecodeError::Version(0))]);
    assert_eq!(result(&[PROTOCOL_VERSION, topic::HELLO, 0]), [Err(DecodeError::Damaged)]);
    assert_eq!(result(&[]), [Err(DecodeError::Damaged)]);
}

#[test]
fn an_unknown_topic_is_skipped_and_its_number_counts() {
    let mut decoder = Decoder::<Message>::new();
    let mut encoder = Encoder::new();
    let message = &longest_messages()[4];
    decode(&mut decoder, &encode(&mut encoder, message));
    encode(&mut encoder, message);
    let found = decode(&mut decoder, &frame_by_hand(PROTOCOL_VERSION, 11, 1, b"news"));
    assert_eq!(found, [Err(DecodeError::Topic(11))]);
    assert_eq!(decode(&mut decoder, &encode(&mut encoder, message)), [Ok(message.clone())]);
    assert_eq!((decoder.counts().unknown, decoder.counts().lost), (1, 0));
}

#[test]
fn a_side_does_not_take_its_own_topics_for_the_other_sides() {
    let mut echo = Decoder::<Message>::new();
    let found = decode(&mut echo, &encode(&mut Encoder::new(), &ping(1)));
    assert_eq!(found, [Err(DecodeError::Topic(topic::REQUEST))]);
}

#[test]
fn bytes_behind_a_body_are_an_error() {
    let mut decoder = Decoder::<Message>::new();
    let bus_recovery = frame_by_hand(PROTOCOL_VERSION, topic::EVENT, 0, &[3]);
    let and_a_byte = frame_by_hand(PROTOCOL_VERSION, topic::EVENT, 1, &[3, 0]);
    assert!(decode(&mut decoder, &bus_recovery)[0].is_ok());
    assert_eq!(decode(&mut decoder, &and_a_byte), [Err(DecodeError::Body(topic::EVENT))]);
    assert_eq!(decoder.counts().unknown, 1);
}

#[test]
fn a_request_with_an_unknown_command_can_be_refused_by_its_number() {
    let mut decoder = Decoder::<Request>::new();
    let found = decode(&mut decoder, &frame_by_hand(PROTOCOL_VERSION, topic::REQUEST, 0, &[0x96, 0x01, 99]));
    assert_eq!(found, [Err(DecodeError::Request(150))]);
}

#[test]
fn a_whole_block_without_a_version_is_damaged() {
    let mut decoder = Decoder::<Message>::new();
    // CRC-32 of nothing is zero.
    let found = decode(&mut decoder, &block_by_hand(&[0; 4]));
    assert_eq!(found, [Err(DecodeError::Damaged)]);
}

#[test]
fn sensor_states_are_printed_by_the_names_of_the_protocol_page() {
    use SensorState::{Inconsistent, Intermittent, Invalid, NoResponse, NotWired, Ok, Stuck, Timeout};
    let page = include_str!("../../../docs/reference/protocol.md");
    let states = [Ok, NoResponse, Stuck, Invalid, Inconsistent, Timeout, Intermittent, NotWired];
    for (number, state) in states.iter().enumerate() {
        let row = format!("| {number} | {state:?} | {state} |");
        assert!(page.contains(&row), "{row}");
    }
}
