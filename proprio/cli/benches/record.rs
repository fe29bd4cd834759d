//! A day of a board's full stream, 8.64 million samples, recorded, replayed by the tool, and opened on the page: what that takes of
//! a core, and of memory, which must not grow with the day: `cargo bench --package proprio --bench record`.

use std::io::{self, BufWriter, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs};

use proprio_link::{Received, StreamDecoder};
use proprio_monitor::{Monitor, Options};
use proprio_session::recording::Recorder;
use proprio_session::{HostNs, LoadedTable};
use telemetry::{
    Encoder, Estimate, Hello, MAX_FRAME, Message, PROTOCOL_VERSION, ResetCause, SCHEMA, Sample, SegmentEstimate, Text,
};

/// Segments of the reference arm.
const SEGMENTS: usize = 6;

const DAY_TICKS: u32 = 8_640_000;
const HOUR_TICKS: u32 = 360_000;
const DAY_S: f64 = 86_400.0;
/// 2025-11-25, ns since 1970.
const START_NS: u64 = 1_764_000_000_000_000_000;
const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../calibration-tables/planar-6.toml");

/// With it, this program opens the recording on the page.
const OPEN: &str = "--open-on-the-page";

fn main() {
    if env::args().any(|argument| argument == OPEN) {
        return open_on_the_page();
    }
    let start = Instant::now();
    record(io::sink(), DAY_TICKS, |tick| {
        if tick % (6 * HOUR_TICKS) == HOUR_TICKS - 1 {
            println!("recorded {:2} h: peak memory {}", tick / HOUR_TICKS + 1, peak_memory("self").unwrap_or_default());
        }
    })
    .expect("nothing is written");
    println!("recorded a day: {:.2} % of a core's time", start.elapsed().as_secs_f64() / DAY_S * 100.0);
    for (name, ticks) in [("a quarter of a day", DAY_TICKS / 4), ("a day", DAY_TICKS)] {
        let mut replay = Command::new(env!("CARGO_BIN_EXE_proprio"));
        replay.args(["replay", "/dev/stdin", "--table", TABLE]);
        let mut open = Command::new(env::current_exe().expect("the system reports it"));
        open.arg(OPEN);
        for (done, mut command) in [("replayed", replay), ("opened on the page", open)] {
            let start = Instant::now();
            let peak = feed(&mut command, ticks).unwrap_or_default();
            let seconds = start.elapsed().as_secs_f64();
            println!("{done} {name}, {ticks} samples, in {seconds:.0} s: peak memory {peak}");
        }
    }
}

/// Records so many ticks of a board.
fn record(sink: impl Write, ticks: u32, mut show: impl FnMut(u32)) -> io::Result<()> {
    let mut recorder = Recorder::new(sink, HostNs(START_NS), "a bench")?;
    let (mut encoder, mut decoder) = (Encoder::new(), StreamDecoder::new(None));
    decoder.open();
    for tick in 0..ticks {
        let at = HostNs(START_NS + u64::from(tick) * 10_000_000);
        for message in messages(tick) {
            let mut buffer = [0; MAX_FRAME];
            let frame = encoder.encode(&message, &mut buffer).expect("it fits");
            recorder.bytes(at, frame)?;
            let mut done = Ok(());
            for byte in frame {
                decoder.push(*byte, |taken| {
                    if let Received::Message(message) = taken {
                        done = recorder.message(at, &message);
                    }
                });
            }
            done?;
        }
        show(tick);
    }
    assert_eq!(decoder.counts().lost, 0);
    recorder.finish().map(drop)
}

/// Feeds so many ticks to a program, by a pipe, as 11 GB a day need not be kept. Gives its peak memory.
fn feed(command: &mut Command, ticks: u32) -> Option<String> {
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null()).spawn().ok()?;
    let pipe = BufWriter::new(child.stdin.take()?);
    let writer = std::thread::spawn(move || record(pipe, ticks, |_| {}));
    let mut peak = None;
    let status = loop {
        peak = peak_memory(&child.id().to_string()).or(peak);
        if let Some(status) = child.try_wait().ok()? {
            break status;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    writer.join().expect("it does not panic").expect("it reads to the end");
    assert!(status.success(), "{status}");
    peak
}

/// The page's session, as a browser fetches it.
fn open_on_the_page() {
    let table = LoadedTable::load(Path::new(TABLE)).expect("the reference table");
    let (folder, session) = (env::temp_dir(), Some("/dev/stdin".into()));
    let options = Options {
        port: 0,
        table: Some(table),
        folder,
        token: None,
        session,
        runtime_folder: None,
        stream: None,
        help: ToString::to_string,
        finding_text: ToString::to_string,
    };
    let monitor = Monitor::start(None, options).expect("a free port");
    let mut stream = TcpStream::connect(monitor.address()).expect("it listens");
    let host = monitor.address();
    write!(stream, "GET /session?name=stdin HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").expect("it reads");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("it answers");
    assert!(answer.len() > 1_000_000, "{}", String::from_utf8_lossy(&answer));
}

fn messages(tick: u32) -> impl Iterator<Item = Message> {
    // Half a turn in five minutes.
    let (sin, cos) = (f64::from(tick) * 1e-4).sin_cos();
    let quaternion = [cos, 0.0, 0.0, sin].map(|part| (part * 16_384.0).round() as i16);
    let segment = Some(SegmentEstimate { theta: tick as i32, end: [1, 2] });
    let sample = Sample {
        tick,
        time_us: u64::from(tick) * 10_000,
        tare_epoch: 1,
        bend: [Some((1500 + tick % 1000) as u16); 2 * SEGMENTS].into_iter().collect(),
        imu: [Some(quaternion); SEGMENTS].into_iter().collect(),
    };
    let estimate = Estimate { tick, segments: [segment; SEGMENTS].into_iter().collect() };
    let messages = [Message::Sample(sample), Message::Estimate(estimate)];
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
        segments: SEGMENTS as u8,
        bend_sensors: 2 * SEGMENTS as u8,
        regulators: 6,
        chip: [0; 16],
        reset: ResetCause::Pin,
        boot: 1,
        last_panic: None,
    }
}

/// A process's peak resident memory, where the system reports it.
fn peak_memory(process: &str) -> Option<String> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    Some(status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().to_owned())
}
