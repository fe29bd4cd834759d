//! A line in memory with a board at its other end, whose requests are judged as the firmware judges them.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use proprio_link::{EventKind, LinkError, LinkEvent, Source, Subscription, Transport};
use telemetry::{
    Command, Decoder, Encoder, Hello, MAX_FRAME, Message, PROTOCOL_VERSION, Refusal, Request, ResetCause, SCHEMA,
    Sample, TareReport, Text, protocol_2,
};

use super::older;

/// Long enough for what comes at all.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// The board and its end of the line.
pub struct Board {
    encoder: Encoder,
    requests: Decoder<Request>,
    server: board_core::CommandServer,
    /// Version of the protocol that it uses.
    pub protocol: u8,
    /// The received bytes since the last zero, of a board of protocol 2.
    block: Vec<u8>,
    /// Received frames of another version.
    pub other_version: usize,
    /// Answers that are lost on their way.
    pub answers_lost: usize,
    /// Reason for which commands are refused.
    pub refuses: Option<Refusal>,
    /// Report that goes before the reply to a request to tare.
    pub pose: Option<TareReport>,
    /// Executed commands, in order.
    pub done: Vec<Command>,
    /// All received requests, executed or not.
    pub received: Vec<Request>,
    to_host: VecDeque<u8>,
    /// All bytes that the host has read.
    pub read: Vec<u8>,
    /// The cable is out.
    pub unplugged: bool,
    began: Instant,
}

impl Board {
    pub fn send(&mut self, message: &Message) {
        let mut buffer = [0; MAX_FRAME];
        let frame = self.encoder.encode(message, &mut buffer).expect("it fits");
        if self.protocol == protocol_2::VERSION {
            self.to_host.extend(older::reply(frame));
        } else {
            self.to_host.extend(frame);
        }
    }

    /// Sends bytes as they are.
    pub fn send_bytes(&mut self, bytes: &[u8]) {
        self.to_host.extend(bytes);
    }

    /// Sends a frame that is lost on its way.
    pub fn lose_frame(&mut self) {
        let mut buffer = [0; MAX_FRAME];
        self.encoder.encode(&Message::Hello(hello(1)), &mut buffer).expect("it fits");
    }

    /// Restarts the board: frames are numbered from 0, and no request is stored.
    pub fn restart(&mut self, boot: u32) {
        (self.encoder, self.server) = (Encoder::new(), board_core::CommandServer::new(boot));
        self.to_host.push_back(0);
        self.send(&Message::Hello(hello(boot)));
    }

    fn receive(&mut self, byte: u8) {
        if self.protocol != protocol_2::VERSION {
            return self.decode(byte);
        }
        if byte != 0 {
            return self.block.push(byte);
        }
        let block = std::mem::take(&mut self.block);
        let session = self.server.session();
        match older::request(&block, session) {
            Some(newer) => newer.into_iter().for_each(|byte| self.decode(byte)),
            None => self.other_version += usize::from(!block.is_empty()),
        }
    }

    fn decode(&mut self, byte: u8) {
        let Some(Ok(request)) = self.requests.push(byte) else { return };
        self.received.push(request.clone());
        let tick = (self.began.elapsed().as_millis() / 10) as u32;
        let (done, refuses) = (&mut self.done, self.refuses);
        let reply = self.server.answer(&request, tick, |command| {
            if let Some(refusal) = refuses.filter(|_| *command != Command::Ping) {
                return Err(refusal);
            }
            done.push(command.clone());
            Ok(board_core::Execution::Done)
        });
        let Some(reply) = reply else { return };
        if let Some(pose) = self.pose.filter(|_| matches!(request.command, Command::Tare(_))) {
            self.send(&Message::Tare(TareReport { id: request.id, ..pose }));
        }
        if self.answers_lost > 0 {
            self.answers_lost -= 1;
        } else {
            self.send(&Message::Reply(reply));
        }
    }
}

/// The line's source: opened again, it has another name.
#[derive(Clone)]
pub struct Line {
    board: Arc<Mutex<Board>>,
    opened: u32,
}

impl Line {
    pub fn new() -> Self {
        let board = Board {
            encoder: Encoder::new(),
            requests: Decoder::new(),
            server: board_core::CommandServer::new(1),
            protocol: PROTOCOL_VERSION,
            block: Vec::new(),
            other_version: 0,
            answers_lost: 0,
            refuses: None,
            pose: None,
            done: Vec::new(),
            received: Vec::new(),
            to_host: VecDeque::new(),
            read: Vec::new(),
            unplugged: false,
            began: Instant::now(),
        };
        Self { board: Arc::new(Mutex::new(board)), opened: 0 }
    }

    pub fn board(&self) -> MutexGuard<'_, Board> {
        self.board.lock().expect("no thread panics with it")
    }
}

impl Source for Line {
    fn open(&mut self) -> Result<(String, Box<dyn Transport>), LinkError> {
        if self.board().unplugged {
            return Err(LinkError::Gone);
        }
        self.opened += 1;
        Ok((format!("line {}", self.opened), Box::new(self.clone())))
    }

    fn can_reconnect(&self) -> bool {
        true
    }
}

impl Transport for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.board().unplugged {
            return Err(io::ErrorKind::BrokenPipe.into());
        }
        let count = buffer.len().min(self.board().to_host.len());
        if count == 0 {
            std::thread::sleep(Duration::from_millis(1));
        }
        let mut board = self.board();
        buffer.iter_mut().zip(board.to_host.drain(..count)).for_each(|(place, byte)| *place = byte);
        board.read.extend(&buffer[..count]);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut board = self.board();
        for byte in bytes {
            board.receive(*byte);
        }
        Ok(())
    }
}

pub fn hello(boot: u32) -> Hello {
    Hello {
        protocol: PROTOCOL_VERSION,
        schema: SCHEMA,
        firmware: text(env!("CARGO_PKG_VERSION")),
        revision: text("abc"),
        arm: text("planar-6"),
        table: 7,
        segments: 6,
        bend_sensors: 12,
        regulators: 6,
        chip: [1; 16],
        reset: ResetCause::Pin,
        boot,
        last_panic: None,
    }
}

pub fn text<const N: usize>(text: &str) -> Text<N> {
    Text::try_from(text).expect("it is short")
}

/// A sample of six segments whose readings depend on its tick.
pub fn sample(tick: u32) -> Sample {
    sample_of(6, tick)
}

/// The same of so many segments.
pub fn sample_of(segments: u32, tick: u32) -> Sample {
    let time_us = u64::from(tick) * 10_000;
    let counts = |i: u32| Some(((tick * 7 + i) % 4096) as u16);
    let quaternion = |i: u32| Some([tick, i, tick / 3, 0].map(|part| (part % 16_384) as i16));
    Sample {
        tick,
        time_us,
        tare_epoch: 0,
        bend: (0..2 * segments).map(counts).collect(),
        imu: (0..segments).map(quaternion).collect(),
    }
}

/// The first event that `pick` wants.
pub fn wait_for<T>(events: &Subscription, mut pick: impl FnMut(&EventKind) -> Option<T>) -> T {
    let end = Instant::now() + PATIENCE;
    while Instant::now() < end {
        if let Some(found) = events.next(Duration::from_millis(50)).and_then(|LinkEvent { kind, .. }| pick(&kind)) {
            return found;
        }
    }
    panic!("it never came");
}
