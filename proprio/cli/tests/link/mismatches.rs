//! A board that does not belong to this program is told by name.

use proprio_link::{Mismatch, Received, StreamDecoder};
use telemetry::{Encoder, Hello, MAX_FRAME, Message};

use super::line::{hello, sample, text};

/// What is told of a board that says hello so, and then sends a sample.
fn told(table: Option<u32>, hello: &Hello) -> Vec<Received> {
    let (mut encoder, mut buffer) = (Encoder::new(), [0; MAX_FRAME]);
    let (mut decoder, mut told) = (StreamDecoder::new(table), Vec::new());
    decoder.open();
    for message in [Message::Hello(hello.clone()), Message::Sample(sample(0)), Message::Hello(hello.clone())] {
        for byte in encoder.encode(&message, &mut buffer).expect("it fits") {
            decoder.push(*byte, |taken| told.push(taken));
        }
    }
    told
}

fn mismatches(told: &[Received]) -> Vec<&Mismatch> {
    told.iter()
        .filter_map(|taken| match taken {
            Received::Mismatch(mismatch) => Some(mismatch),
            _ => None,
        })
        .collect()
}

#[test]
fn a_board_of_this_release_with_the_table_that_was_given_has_none() {
    let told = told(Some(7), &hello(1));
    assert_eq!((mismatches(&told).len(), told.len()), (0, 3));
}

#[test]
fn another_table_is_told_once_with_both_checksums() {
    let told = told(Some(8), &hello(1));
    let expected = Mismatch::Table { arm: "planar-6".to_owned(), board: 7, given: 8 };
    assert_eq!(mismatches(&told), [&expected]);
    assert!(expected.to_string().contains("00000007") && expected.to_string().contains("proprio flash"));
}

#[test]
fn messages_of_another_form_are_not_handed_on() {
    let told = told(None, &Hello { schema: 1, firmware: text("0.9.0"), ..hello(1) });
    let expected = Mismatch::Schema { board: Some(1), firmware: Some("0.9.0".to_owned()) };
    assert_eq!(mismatches(&told), [&expected]);
    assert!(!told.iter().any(|taken| matches!(taken, Received::Message(Message::Sample(_)))), "{told:?}");
}

#[test]
fn messages_whose_hash_covered_the_names_of_the_same_layout_are_handed_on() {
    let told = told(None, &Hello { schema: 0x03c8_8117, ..hello(1) });
    assert_eq!((mismatches(&told).len(), told.len()), (0, 3));
}

#[test]
fn another_firmware_that_says_the_same_messages_is_read_and_told() {
    let told = told(None, &Hello { firmware: text("0.9.0"), ..hello(1) });
    assert_eq!(mismatches(&told), [&Mismatch::Firmware("0.9.0".to_owned())]);
    assert!(told.iter().any(|taken| matches!(taken, Received::Message(Message::Sample(_)))));
}

#[test]
fn another_version_of_the_protocol_is_told() {
    // COBS( 1 | CRC-32 ): a frame of version 1 without anything in it, as zip's CRC-32 of the byte 01 has it.
    let crc: [u8; 4] = 0xa505_df1b_u32.to_le_bytes();
    let frame = [&[6, 1], &crc[..], &[0]].concat();
    let (mut decoder, mut told) = (StreamDecoder::new(None), Vec::new());
    decoder.open();
    for byte in frame {
        decoder.push(byte, |taken| told.push(taken));
    }
    assert_eq!(mismatches(&told), [&Mismatch::Protocol(1)]);
}
