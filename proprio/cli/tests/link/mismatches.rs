//! Mismatches of board and program are reported.

use proprio_link::{Mismatch, Received, StreamDecoder};
use telemetry::{Encoder, Hello, MAX_FRAME, Message};

use super::line::{hello, sample, text};

/// Parts of the stream of a board that sends this `Hello`, a sample and the `Hello` again.
fn received(table: Option<u32>, hello: &Hello) -> Vec<Received> {
    let (mut encoder, mut buffer) = (Encoder::new(), [0; MAX_FRAME]);
    let (mut decoder, mut received) = (StreamDecoder::new(table), Vec::new());
    decoder.open();
    for message in [Message::Hello(hello.clone()), Message::Sample(sample(0)), Message::Hello(hello.clone())] {
        for byte in encoder.encode(&message, &mut buffer).expect("it fits") {
            decoder.push(*byte, |part| received.push(part));
        }
    }
    received
}

fn mismatches(received: &[Received]) -> Vec<&Mismatch> {
    received
        .iter()
        .filter_map(|part| match part {
            Received::Mismatch(mismatch) => Some(mismatch),
            _ => None,
        })
        .collect()
}

#[test]
fn a_board_of_this_release_with_the_table_that_was_given_has_none() {
    let received = received(Some(7), &hello(1));
    assert_eq!((mismatches(&received).len(), received.len()), (0, 3));
}

#[test]
fn another_table_is_reported_once_with_both_checksums() {
    let received = received(Some(8), &hello(1));
    let expected = Mismatch::Table { arm: "planar-6".to_owned(), board: 7, given: 8 };
    assert_eq!(mismatches(&received), [&expected]);
    assert!(expected.to_string().contains("00000007") && expected.to_string().contains("proprio table push"));
}

#[test]
fn messages_of_another_form_are_not_handed_on() {
    let received = received(None, &Hello { schema: 1, firmware: text("0.9.0"), ..hello(1) });
    let expected = Mismatch::Schema { board: Some(1), firmware: Some("0.9.0".to_owned()) };
    assert_eq!(mismatches(&received), [&expected]);
    assert!(!received.iter().any(|part| matches!(part, Received::Message(Message::Sample(_)))), "{received:?}");
}

#[test]
fn messages_whose_hash_covered_the_names_of_the_same_layout_are_handed_on() {
    let received = received(None, &Hello { schema: 0x03c8_8117, ..hello(1) });
    assert_eq!((mismatches(&received).len(), received.len()), (0, 3));
}

#[test]
fn another_firmware_with_the_same_messages_is_read_and_reported() {
    let received = received(None, &Hello { firmware: text("0.9.0"), ..hello(1) });
    assert_eq!(mismatches(&received), [&Mismatch::Firmware("0.9.0".to_owned())]);
    assert!(received.iter().any(|part| matches!(part, Received::Message(Message::Sample(_)))));
}

#[test]
fn another_version_of_the_protocol_is_reported() {
    // COBS( 1 | CRC-32 ): a frame of version 1 without anything in it, as zip's CRC-32 of the byte 01 has it.
    let crc: [u8; 4] = 0xa505_df1b_u32.to_le_bytes();
    let frame = [&[6, 1], &crc[..], &[0]].concat();
    let (mut decoder, mut received) = (StreamDecoder::new(None), Vec::new());
    decoder.open();
    for byte in frame {
        decoder.push(byte, |part| received.push(part));
    }
    assert_eq!(mismatches(&received), [&Mismatch::Protocol(1)]);
}
