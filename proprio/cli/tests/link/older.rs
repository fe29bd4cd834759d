//! A board of protocol 2 on the line: its frames, and what a host sends and receives.

use std::time::{Duration, Instant};

use proprio_link::{EventKind, Link, Tared, tare};
use proprio_session::recording::{Item, Reader};
use telemetry::{Command, Message, PROTOCOL_VERSION, SetPressures, TareMode, protocol_2};

use super::line::{Line, PATIENCE, wait_for};

/// Topic, number and body of a frame of this version, without its zero.
fn content(block: &[u8], version: u8) -> Option<Vec<u8>> {
    let mut content = vec![0; block.len()];
    let length = cobs::decode(block, &mut content).ok()?.frame_size();
    content.truncate(length.checked_sub(4)?);
    let (found, rest) = content.split_first()?;
    (*found == version).then(|| rest.to_vec())
}

/// The frame with this content, its zero included.
fn frame(version: u8, rest: &[u8]) -> Vec<u8> {
    let mut content = [&[version], rest].concat();
    content.extend(crc32fast::hash(&content).to_le_bytes());
    let mut block = vec![0; content.len() + 2];
    let length = cobs::encode(&content, &mut block);
    block.truncate(length + 1);
    block
}

/// A reply as a frame of protocol 2, without the session.
pub fn reply(newer: &[u8]) -> Vec<u8> {
    let (_, block) = newer.split_last().expect("a frame has a zero");
    let mut rest = content(block, PROTOCOL_VERSION).expect("a frame of this program");
    // Behind the topic and the number: the id, which is below 128 here, and the session, which is not.
    rest.drain(4..6);
    frame(protocol_2::VERSION, &rest)
}

/// A request of protocol 2 as a frame of protocol 3 in a session; `None`: it is of another version.
pub fn request(block: &[u8], session: u16) -> Option<Vec<u8>> {
    let mut rest = content(block, protocol_2::VERSION)?;
    // Behind the topic and the number: the id, which is below 128 here, and the command.
    match rest[4] {
        // A tare has no mode.
        1 => rest.push(0),
        // Six pressures without their number.
        5 => rest.insert(5, 6),
        _ => {}
    }
    rest.splice(4..4, [session as u8 | 0x80, (session >> 7) as u8]);
    Some(frame(PROTOCOL_VERSION, &rest))
}

/// The bytes of a board of protocol 2 from its boot on.
fn recorded() -> Vec<u8> {
    let recording = include_bytes!("../../../../host-tests/recordings/earlier-schema-hash.mcap");
    let bytes = Reader::new(&recording[..]).filter_map(|item| match item.expect("it is whole") {
        Item::Bytes(_, bytes) => Some(bytes),
        _ => None,
    });
    bytes.collect::<Vec<_>>().concat()
}

#[test]
fn a_board_of_protocol_2_gets_requests_in_version_2_and_its_samples_arrive() {
    let line = Line::new();
    line.board().protocol = protocol_2::VERSION;
    let (link, events) = Link::start(Box::new(line.clone()), None).expect("memory opens");
    let end = Instant::now() + PATIENCE;
    while line.board().other_version == 0 {
        assert!(Instant::now() < end, "the host sends the newest version first");
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(!link.state().is_connected && line.board().received.is_empty());

    line.board().send_bytes(&recorded());
    let sample = wait_for(&events, |kind| match kind {
        EventKind::Message(Message::Sample(sample)) => Some(sample.clone()),
        _ => None,
    });
    assert_eq!((sample.tick, sample.bend.len(), sample.imu.len()), (0, 12, 6));
    link.wait_until_connected().expect("the Ping is repeated in its version");
    assert_eq!(link.state().hello.map(|hello| (hello.protocol, hello.segments, hello.regulators)), Some((2, 6, 6)));

    link.request(Command::Arm).expect("it is done");
    let pressures_pa = [1000, 0, 0, 0, 0, 6000].into_iter().collect();
    let pressures = Command::SetPressures(SetPressures { pressures_pa, valid_ms: 300 });
    link.request(pressures.clone()).expect("it is done");
    // It reports no pose.
    assert_eq!(tare(&link, TareMode::IfStill).expect("it is done"), Tared(None));
    let done = line.board().done.clone();
    assert_eq!(done, [Command::Ping, Command::Arm, pressures, Command::Tare(TareMode::IfStill)]);
}
