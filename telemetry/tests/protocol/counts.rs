//! Lost frames are counted, and only those.

use proptest::prelude::*;
use telemetry::{Decoder, Encoder, Event, Hello, Message};

use crate::values::{longest_hello, ping};
use crate::{decode, encode};

fn hello(boot: u32) -> Message {
    Message::Hello(Hello { boot, ..longest_hello() })
}

const TICK: Message = Message::Event(Event::BusRecovery);

/// Encodes `count` messages that are lost.
fn lose(encoder: &mut Encoder, count: u32) {
    for _ in 0..count {
        encode(encoder, &TICK);
    }
}

fn send(encoder: &mut Encoder, decoder: &mut Decoder<Message>, message: &Message) {
    assert_eq!(decode(decoder, &encode(encoder, message)), [Ok(message.clone())]);
}

proptest! {
    #[test]
    fn every_lost_frame_is_counted(gaps in prop::collection::vec(0_u32..300, 1..10)) {
        let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
        for gap in &gaps {
            send(&mut encoder, &mut decoder, &TICK);
            lose(&mut encoder, *gap);
        }
        send(&mut encoder, &mut decoder, &TICK);
        prop_assert_eq!(decoder.counts().lost, gaps.iter().sum::<u32>());
        prop_assert_eq!(decoder.counts().received as usize, gaps.len() + 1);
    }
}

#[test]
fn a_damaged_frame_is_lost_too() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    send(&mut encoder, &mut decoder, &TICK);
    let mut frame = encode(&mut encoder, &TICK);
    frame[2] ^= 0x40;
    decode(&mut decoder, &frame);
    send(&mut encoder, &mut decoder, &TICK);
    assert_eq!((decoder.counts().damaged, decoder.counts().lost), (1, 1));
}

#[test]
fn numbers_wrap_without_a_loss() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    for id in 0..70_000 {
        let frame = encode(&mut encoder, &ping(id));
        assert_eq!(decode(&mut decoder, &frame), [Ok(ping(id))]);
    }
    assert_eq!((decoder.counts().received, decoder.counts().lost), (70_000, 0));
}

#[test]
fn a_loss_across_the_wrap_is_counted() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    lose(&mut encoder, 65_530);
    send(&mut encoder, &mut decoder, &TICK);
    lose(&mut encoder, 20);
    send(&mut encoder, &mut decoder, &TICK);
    assert_eq!(decoder.counts().lost, 20);
}

#[test]
fn frames_before_the_first_are_not_lost() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    lose(&mut encoder, 1000);
    send(&mut encoder, &mut decoder, &TICK);
    assert_eq!(decoder.counts().lost, 0);
}

#[test]
fn a_frame_that_comes_twice_is_no_loss() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::<Message>::new());
    let frame = encode(&mut encoder, &TICK);
    decode(&mut decoder, &frame);
    decode(&mut decoder, &frame);
    send(&mut encoder, &mut decoder, &TICK);
    assert_eq!(decoder.counts().lost, 0);
}

#[test]
fn what_is_lost_behind_a_piece_that_came_twice_is_counted_once() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::<Message>::new());
    let frames: Vec<_> = (0..10).map(|_| encode(&mut encoder, &TICK)).collect();
    // 0 to 4, then 2 and 3 again, and 7 is the next.
    for i in [0, 1, 2, 3, 4, 2, 3, 7, 8] {
        decode(&mut decoder, &frames[i]);
    }
    assert_eq!(decoder.counts().lost, 2);
}

#[test]
fn a_reboot_after_a_few_frames_is_counted_anew() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    send(&mut encoder, &mut decoder, &hello(1));
    for _ in 0..100 {
        send(&mut encoder, &mut decoder, &TICK);
    }
    let mut rebooted = Encoder::new();
    send(&mut rebooted, &mut decoder, &hello(2));
    lose(&mut rebooted, 3);
    send(&mut rebooted, &mut decoder, &TICK);
    assert_eq!(decoder.counts().lost, 3);
}

#[test]
fn a_reboot_is_no_loss_whatever_the_number_before_it() {
    for before in [100, 40_000, 65_000] {
        let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
        send(&mut encoder, &mut decoder, &hello(1));
        lose(&mut encoder, 3);
        send(&mut encoder, &mut decoder, &TICK);
        send(&mut encoder, &mut decoder, &hello(1));
        for _ in 0..before {
            decode(&mut decoder, &encode(&mut encoder, &TICK));
        }
        let mut rebooted = Encoder::new();
        send(&mut rebooted, &mut decoder, &hello(2));
        send(&mut rebooted, &mut decoder, &TICK);
        assert_eq!(decoder.counts().lost, 3, "after {before} frames");
    }
}

#[test]
fn a_reboot_whose_first_hello_was_lost_is_put_right_by_the_second() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    send(&mut encoder, &mut decoder, &hello(1));
    for _ in 0..40_000 {
        decode(&mut decoder, &encode(&mut encoder, &TICK));
    }
    let mut rebooted = Encoder::new();
    lose(&mut rebooted, 1);
    send(&mut rebooted, &mut decoder, &TICK);
    send(&mut rebooted, &mut decoder, &hello(2));
    lose(&mut rebooted, 5);
    send(&mut rebooted, &mut decoder, &hello(2));
    assert_eq!(decoder.counts().lost, 5);
}
