//! A day of a board's full stream, 8.64 million samples, decoded and recorded: `cargo bench --package proprio --bench record`.

use std::fs;
use std::io;
use std::time::Instant;

use proprio::link::{HostNs, Intake, Taken};
use proprio::recording::Recorder;
use telemetry::{
    BEND_SENSORS, Encoder, Estimate, Hello, MAX_FRAME, Message, PROTOCOL_VERSION, ResetCause, SCHEMA, SEGMENTS, Sample,
    SegmentEstimate, Text,
};

const DAY_TICKS: u32 = 8_640_000;
const HOUR_TICKS: u32 = 360_000;
/// 2025-11-25, ns since 1970.
const START_NS: u64 = 1_764_000_000_000_000_000;

fn main() {
    let mut recorder = Recorder::new(io::sink(), HostNs(START_NS), "a bench").expect("nothing is written");
    let (mut encoder, mut intake) = (Encoder::new(), Intake::new(None));
    intake.open();
    let start = Instant::now();
    for tick in 0..DAY_TICKS {
        let at = HostNs(START_NS + u64::from(tick) * 10_000_000);
        for message in messages(tick) {
            let mut buffer = [0; MAX_FRAME];
            let frame = encoder.encode(&message, &mut buffer).expect("it fits");
            recorder.bytes(at, frame).expect("nothing is written");
            for byte in frame {
                intake.push(*byte, |taken| {
                    if let Taken::Message(message) = taken {
                        recorder.message(at, &message).expect("nothing is written");
                    }
                });
            }
        }
        if tick % (6 * HOUR_TICKS) == HOUR_TICKS - 1 {
            println!("after {:2} h: peak memory {}", tick / HOUR_TICKS + 1, peak_memory().unwrap_or_default());
        }
    }
    assert_eq!(intake.counts().lost, 0);
    recorder.finish().expect("nothing is written");
    let share = start.elapsed().as_secs_f64() / f64::from(DAY_TICKS) * 100.0;
    println!("a day: {:.2} % of a core's time, peak memory {}", share * 100.0, peak_memory().unwrap_or_default());
}

fn messages(tick: u32) -> impl Iterator<Item = Message> {
    let segment = Some(SegmentEstimate { theta: tick as i32, end: [1, 2] });
    let sample = Sample {
        tick,
        time_us: u64::from(tick) * 10_000,
        tare: 1,
        bend: [Some((tick % 4096) as u16); BEND_SENSORS],
        imu: [Some([tick as i16, 0, 0, 1]); SEGMENTS],
    };
    let messages = [Message::Sample(sample), Message::Estimate(Estimate { tick, segments: [segment; SEGMENTS] })];
    (tick.is_multiple_of(100)).then(|| Message::Hello(hello())).into_iter().chain(messages)
}

fn hello() -> Hello {
    Hello {
        protocol: PROTOCOL_VERSION,
        schema: SCHEMA,
        firmware: Text::new(),
        revision: Text::new(),
        arm: Text::new(),
        table: 0,
        chip: [0; 16],
        reset: ResetCause::Pin,
        boot: 1,
        last_panic: None,
    }
}

/// The process's peak resident memory, where the system tells.
fn peak_memory() -> Option<String> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    Some(status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().to_owned())
}
