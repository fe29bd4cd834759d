//! The board on a pseudo-terminal in real time; the test has access to the rig and to the line.

use std::collections::VecDeque;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

use board_tests::{UART, machine};
use rig_twin::Scenario;
use serialport::{SerialPort, TTYPort};
use virtual_due::{CYCLES_PER_SECOND, Machine, WiredRig};

/// Time that the board runs between two transfers, ms.
const SLICE_MS: u64 = 2;

/// Bytes that wait for a reader; further ones are lost, as in the USB bridge.
const ROOM: usize = 1 << 16;

/// The board, and our end of its line.
pub struct Terminal {
    /// The emulated board.
    pub machine: Machine<WiredRig>,
    line: TTYPort,
    port: String,
    /// Disturbance of the line: the bytes that arrive for those that the board sent.
    pub disturb: Box<dyn FnMut(Vec<u8>) -> Vec<u8>>,
    to_host: VecDeque<u8>,
}

impl Terminal {
    /// A board whose power comes up with the first byte from the host: the port is open by then.
    pub fn new() -> Self {
        let (mut line, theirs) = TTYPort::pair().expect("the system has pseudo-terminals");
        let port = theirs.name().expect("it has a name");
        line.set_timeout(Duration::from_millis(1)).expect("it is set");
        let machine = machine(WiredRig::new(Scenario::FreeSwing, 1));
        Self { machine, line, port, disturb: Box::new(|bytes| bytes), to_host: VecDeque::new() }
    }

    /// Path of the other end, for programs.
    pub fn port(&self) -> &str {
        &self.port
    }

    /// Waits for the first byte, then lets the board run until `is_done`, which is called every two milliseconds.
    ///
    /// # Panics
    /// After five minutes.
    pub fn run_until(&mut self, mut is_done: impl FnMut(&mut Machine<WiredRig>) -> bool) {
        let deadline = Instant::now() + Duration::from_mins(5);
        let (mut begin, start) = (None, self.machine.now());
        while !is_done(&mut self.machine) {
            assert!(Instant::now() < deadline, "it is not done within five minutes");
            let mut bytes = [0; 4096];
            let count = self.line.read(&mut bytes).unwrap_or(0);
            let now = self.machine.now();
            if count == 0 && now == 0 {
                std::thread::sleep(Duration::from_millis(1));
                continue;
            }
            self.machine.world_mut().send(UART, &bytes[..count], now);
            self.machine.run_until(now + SLICE_MS * CYCLES_PER_SECOND / 1000);
            self.send();
            let passed = (self.machine.now() - start) as f64 / CYCLES_PER_SECOND as f64;
            let due = *begin.get_or_insert_with(Instant::now) + Duration::from_secs_f64(passed);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }

    fn send(&mut self) {
        let sent = self.machine.world_mut().take_transmitted(UART).into_iter().map(|(_, byte)| byte).collect();
        self.to_host.extend((self.disturb)(sent));
        // There may be no reader.
        let written = self.line.write(self.to_host.make_contiguous()).unwrap_or(0);
        self.to_host.drain(..written);
        self.to_host.truncate(ROOM);
    }
}
