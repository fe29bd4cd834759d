//! Sessions of arms of any length on their way through files.

use proprio_session::recording::{Item, Reader, Recorder};
use proprio_session::{HostNs, RequiredColumns, Row, SessionReader};
use telemetry::{Encoder, Estimate, Hello, MAX_FRAME, Message, PROTOCOL_VERSION, ResetCause, SCHEMA, Sample, Text};

use super::common::Folder;

/// Time of a sample's arrival, ns.
fn at(sample: &Sample) -> HostNs {
    HostNs(1_764_000_000_000_000_000 + sample.time_us * 1000)
}

fn hello(segments: u8) -> Hello {
    Hello {
        protocol: PROTOCOL_VERSION,
        schema: SCHEMA,
        firmware: Text::new(),
        revision: Text::new(),
        arm: Text::new(),
        table: 0,
        segments,
        bend_sensors: 2 * segments - 1,
        regulators: 2,
        chip: [0; 16],
        reset: ResetCause::Pin,
        boot: 1,
        last_panic: None,
    }
}

/// Two seconds of an arm whose last bend sensor is not wired and whose last IMU is silent.
fn samples(segments: u8) -> Vec<Sample> {
    let sample = |tick: u32| {
        // Unit quaternions in units of 2⁻¹⁴: the headings of a turn in eighths.
        let turns = [[16_384, 0, 0, 0], [15_137, 0, 0, 6270], [11_585, 0, 0, 11_585], [6270, 0, 0, 15_137]];
        let counts = |i: u32| (i + 1 < 2 * u32::from(segments)).then_some(((tick * 31 + i * 97) % 4096) as u16);
        let imu = |i: u32| (i + 1 < u32::from(segments)).then_some(turns[(tick + i) as usize % turns.len()]);
        Sample {
            tick,
            time_us: u64::from(tick) * 10_000,
            tare_epoch: 0,
            bend: (0..2 * u32::from(segments)).map(counts).collect(),
            imu: (0..u32::from(segments)).map(imu).collect(),
        }
    };
    (0..200).map(sample).collect()
}

fn recording(segments: u8, samples: &[Sample]) -> Vec<u8> {
    let mut recorder = Recorder::new(Vec::new(), HostNs(0), "a test").expect("memory takes all");
    let (mut encoder, mut buffer) = (Encoder::new(), [0; MAX_FRAME]);
    let mut write = |at: HostNs, message: &Message| {
        recorder.bytes(at, encoder.encode(message, &mut buffer).expect("it fits")).expect("memory takes all");
        recorder.message(at, message).expect("memory takes all");
    };
    write(at(&samples[0]), &Message::Hello(hello(segments)));
    for sample in samples {
        write(at(sample), &Message::Sample(sample.clone()));
        let estimate = Estimate { tick: sample.tick, segments: sample.imu.iter().map(|_| None).collect() };
        write(at(sample), &Message::Estimate(estimate));
    }
    recorder.finish().expect("memory takes all")
}

fn rows(folder: &Folder, name: &str, segments: u8) -> Vec<Row> {
    let needs = RequiredColumns { bend: vec![None; segments.into()], truth: false };
    let mut reader = SessionReader::open(folder.path(name).as_ref(), &needs).expect("a session");
    std::iter::from_fn(|| reader.next_row().expect("a session")).collect()
}

#[test]
fn arms_of_three_and_eight_segments_are_read_from_a_recording_to_the_bit() {
    for segments in [3, 8] {
        let sent = samples(segments);
        let folder = Folder::with("session.mcap", recording(segments, &sent));
        let rows = rows(&folder, "session.mcap", segments);
        assert_eq!(rows.len(), sent.len());
        for (row, sent) in rows.iter().zip(&sent) {
            assert_eq!(row.sample, sent.into());
            let board = row.board.as_ref().expect("it is recorded");
            assert_eq!(board.segments, usize::from(segments));
            assert_eq!(board.estimate.as_ref().map(|estimate| estimate.segments.len()), Some(segments.into()));
        }
    }
}

#[test]
fn a_recording_of_another_number_of_segments_than_the_arm_is_refused_with_both() {
    for (segments, arm) in [(3, 8), (8, 3)] {
        let folder = Folder::with("session.mcap", recording(segments, &samples(segments)));
        let needs = RequiredColumns { bend: vec![None; arm], truth: false };
        let error = SessionReader::open(folder.path("session.mcap").as_ref(), &needs).err().expect("another arm");
        let expected = format!("is a recording of a board with {segments} segments, the arm has {arm}");
        assert!(error.to_string().ends_with(&expected), "{error}");
    }
}

#[test]
fn a_csv_has_the_columns_of_the_arm_s_segments_and_comes_back_to_the_bit() {
    for segments in [3_u8, 8] {
        let sent = samples(segments);
        let folder = Folder::with("session.mcap", recording(segments, &sent));
        folder.done(&["convert", "session.mcap", "session.csv"]);
        let csv = folder.read("session.csv");
        let header: Vec<&str> = csv.lines().next().expect("a header").split(',').collect();
        let count = |prefix: &str| header.iter().filter(|name| name.starts_with(prefix)).count();
        assert_eq!((count("bend"), count("imu")), (2 * usize::from(segments) - 1, 4 * usize::from(segments)));

        folder.done(&["convert", "session.csv", "back.mcap"]);
        let back = std::fs::read(folder.path("back.mcap")).expect("it was written");
        let mut decoder = telemetry::Decoder::<Message>::new();
        let mut read = Vec::new();
        for item in Reader::new(&back[..]) {
            let Item::Bytes(_, bytes) = item.expect("it is whole") else { continue };
            for message in bytes.into_iter().filter_map(|byte| decoder.push(byte)) {
                if let Message::Sample(sample) = message.expect("nothing is damaged") {
                    read.push(sample);
                }
            }
        }
        assert_eq!(read, sent);
    }
}
