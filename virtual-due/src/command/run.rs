//! A run: the board in slices of time, with input and output between them.

use super::flash_file::FlashFile;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use virtual_due::rig::WiredRig;
use virtual_due::{CYCLES_PER_SECOND, Cycles, Machine};

/// Time that the board runs between two transfers.
const SLICE: Cycles = CYCLES_PER_SECOND / 500;
/// Time between two looks at the flash, for its file.
const FLASH_PERIOD: Cycles = CYCLES_PER_SECOND / 10;
/// The UART, which is the programming port.
const PORT: usize = 0;
/// Time by which the slowest watchdog has reset a locked core.
const LOCKED_UP_TOO_LONG: Cycles = 20 * CYCLES_PER_SECOND;

/// The other end of the serial line.
pub trait Line {
    /// Takes the bytes received from it.
    fn receive(&mut self) -> std::io::Result<Received>;

    /// Sends bytes of the board; false if the reader has gone.
    fn send(&mut self, bytes: &[u8]) -> std::io::Result<bool>;
}

/// Input of the serial line.
#[derive(Debug, Default)]
pub struct Received {
    /// A program opened the port, which resets the board.
    pub opened: bool,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A board that runs a firmware.
pub struct Run {
    machine: Machine<WiredRig>,
    flash: Option<FlashFile>,
    end: Option<Cycles>,
    paced: bool,
    began: Instant,
    resets_printed: usize,
    locked_up: Option<Cycles>,
}

impl Run {
    /// A run of `seconds`, or without end; at most as fast as real time if it is `paced`.
    pub fn new(machine: Machine<WiredRig>, flash: Option<FlashFile>, seconds: Option<f64>, paced: bool) -> Self {
        let end = seconds.map(|seconds| (seconds * CYCLES_PER_SECOND as f64) as Cycles);
        Self { machine, flash, end, paced, began: Instant::now(), resets_printed: 0, locked_up: None }
    }

    /// Runs to the end, or until Ctrl-C, or until the reader has gone; calls `inject` before every slice.
    pub fn execute(
        &mut self,
        line: &mut dyn Line,
        mut inject: impl FnMut(&mut Machine<WiredRig>),
    ) -> std::io::Result<()> {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(std::io::Error::other)?;
        let end = self.end.unwrap_or(Cycles::MAX);
        let mut now = 0;
        while now < end && !stop.load(Ordering::Relaxed) && !self.is_locked_up_for_good() {
            let Received { opened, bytes } = line.receive()?;
            if opened {
                self.machine.press_reset();
            }
            if !bytes.is_empty() {
                self.machine.world_mut().send(PORT, &bytes, now);
            }
            inject(&mut self.machine);
            now = end.min(now + SLICE);
            self.machine.run_until(now);
            // After a reset the board may say what its flash holds: the file must hold it, too.
            if self.print_reports() || now.is_multiple_of(FLASH_PERIOD) {
                self.keep_flash()?;
            }
            let sent: Vec<u8> =
                self.machine.world_mut().take_transmitted(PORT).into_iter().map(|(_, byte)| byte).collect();
            if !line.send(&sent)? {
                break;
            }
            self.pace(now);
        }
        self.keep_flash()
    }

    fn keep_flash(&mut self) -> std::io::Result<()> {
        self.flash.as_mut().map_or(Ok(()), |flash| flash.keep(&self.machine))
    }

    /// True if the core has been locked up for longer than any watchdog takes.
    fn is_locked_up_for_good(&mut self) -> bool {
        if !self.machine.locked_up() {
            self.locked_up = None;
            return false;
        }
        let now = self.machine.now();
        now - *self.locked_up.get_or_insert(now) > LOCKED_UP_TOO_LONG
    }

    /// Prints what has happened; returns true if there was a reset.
    fn print_reports(&mut self) -> bool {
        for report in self.machine.reports() {
            eprintln!("{report}");
        }
        for reset in &self.machine.resets()[self.resets_printed..] {
            eprintln!("reset at {:.6} s: {:?}", seconds(reset.at), reset.cause);
        }
        let before = std::mem::replace(&mut self.resets_printed, self.machine.resets().len());
        before < self.resets_printed
    }

    /// Waits until real time has reached virtual time `now`.
    fn pace(&self, now: Cycles) {
        if self.paced {
            let due = self.began + Duration::from_secs_f64(seconds(now));
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }

    /// Prints a summary of the run; returns the exit status.
    pub fn summary(&self) -> ExitCode {
        let machine = &self.machine;
        let (virtual_s, wall_s) = (machine.seconds(), self.began.elapsed().as_secs_f64());
        // An instruction takes 1.4 cycles.
        let load = machine.instructions() as f64 * 1.4 / machine.now().max(1) as f64;
        eprintln!(
            "{virtual_s:.3} s in {wall_s:.3} s, {} instructions, load {:.1} %, {} resets, pc {:#010x}",
            machine.instructions(),
            100.0 * load,
            machine.resets().len(),
            machine.pc()
        );
        if machine.locked_up() { ExitCode::FAILURE } else { ExitCode::SUCCESS }
    }
}

fn seconds(cycles: Cycles) -> f64 {
    cycles as f64 / CYCLES_PER_SECOND as f64
}
