//! A run: the board in slices of time, with input and output between them.

use super::flash_file::FlashFile;
use super::observation::{Observer, Verdict};
use super::pins_file::PinsFile;
use super::truth_file::TruthFile;
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

    /// Ends a line of output that has begun where the reports go, too, so that a report has a line of its own.
    fn end_line(&mut self) {}
}

/// Input of the serial line.
#[derive(Debug, Default)]
pub struct Received {
    /// A program opened the port, which resets the board.
    pub opened: bool,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// Files that a run writes, and its observer.
#[derive(Default)]
pub struct Recorders {
    /// The file of the flash.
    pub flash: Option<FlashFile>,
    /// The file of the truth.
    pub truth: Option<TruthFile>,
    /// The file of the pins' changes.
    pub pins: Option<PinsFile>,
    /// The observer of the run.
    pub observer: Observer,
}

/// A board that runs a firmware.
pub struct Run {
    machine: Machine<WiredRig>,
    recorders: Recorders,
    end: Option<Cycles>,
    paced: bool,
    began: Instant,
    resets_printed: usize,
    locked_up: Option<Cycles>,
    /// The end of the slice under way, or of the last one.
    slice_end: Cycles,
    in_slice: bool,
    reader_gone: bool,
    stop: Arc<AtomicBool>,
}

/// Result of an advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Progress {
    /// The end of a slice.
    Running,
    /// A breakpoint.
    Breakpoint,
    /// One instruction.
    Stepped,
    /// The end of the run.
    Over,
}

impl Run {
    /// A run of `seconds`, or without end; at most as fast as real time if it is `paced`.
    /// Ctrl-C ends it.
    ///
    /// # Errors
    /// Those of the system, if it takes no handler of Ctrl-C.
    pub fn new(
        machine: Machine<WiredRig>,
        recorders: Recorders,
        seconds: Option<f64>,
        paced: bool,
    ) -> std::io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(std::io::Error::other)?;
        Ok(Self {
            machine,
            recorders,
            end: seconds.map(|seconds| (seconds * CYCLES_PER_SECOND as f64) as Cycles),
            paced,
            began: Instant::now(),
            resets_printed: 0,
            locked_up: None,
            slice_end: 0,
            in_slice: false,
            reader_gone: false,
            stop,
        })
    }

    /// Runs to the end, or until Ctrl-C, a verdict, or until the reader has gone; calls `inject` before every slice.
    pub fn execute(
        &mut self,
        line: &mut dyn Line,
        inject: &mut dyn FnMut(&mut Machine<WiredRig>),
    ) -> std::io::Result<()> {
        while self.advance(line, inject)? != Progress::Over {}
        line.end_line();
        self.finish()
    }

    /// Runs to the end of the slice, or to a breakpoint.
    pub fn advance(
        &mut self,
        line: &mut dyn Line,
        inject: &mut dyn FnMut(&mut Machine<WiredRig>),
    ) -> std::io::Result<Progress> {
        self.run_slice(line, inject, |machine, end| machine.run_to_breakpoint(end).then_some(Progress::Breakpoint))
    }

    /// Runs one instruction, or sleeps to the end of the slice.
    pub fn step(
        &mut self,
        line: &mut dyn Line,
        inject: &mut dyn FnMut(&mut Machine<WiredRig>),
    ) -> std::io::Result<Progress> {
        self.run_slice(line, inject, |machine, end| machine.step(end).then_some(Progress::Stepped))
    }

    /// Runs in the slice under way or the next one, up to its end unless `run` returns the reason of an earlier stop.
    fn run_slice(
        &mut self,
        line: &mut dyn Line,
        inject: &mut dyn FnMut(&mut Machine<WiredRig>),
        run: impl FnOnce(&mut Machine<WiredRig>, Cycles) -> Option<Progress>,
    ) -> std::io::Result<Progress> {
        if !self.begin_slice(line, inject)? {
            return Ok(Progress::Over);
        }
        if let Some(stopped) = run(&mut self.machine, self.slice_end) {
            return Ok(stopped);
        }
        self.end_slice(line)?;
        Ok(Progress::Running)
    }

    /// Begins a slice, unless one is under way; false if the run is over.
    fn begin_slice(
        &mut self,
        line: &mut dyn Line,
        inject: &mut dyn FnMut(&mut Machine<WiredRig>),
    ) -> std::io::Result<bool> {
        if self.in_slice {
            return Ok(true);
        }
        let (now, end) = (self.slice_end, self.end.unwrap_or(Cycles::MAX));
        if now == 0 {
            self.keep_truth(now)?;
        }
        if now >= end || self.is_over() {
            return Ok(false);
        }
        let Received { opened, bytes } = line.receive()?;
        if opened {
            self.machine.press_reset();
        }
        if !bytes.is_empty() {
            self.machine.world_mut().send(PORT, &bytes, now);
        }
        inject(&mut self.machine);
        self.slice_end = end.min(now + SLICE);
        self.in_slice = true;
        Ok(true)
    }

    fn end_slice(&mut self, line: &mut dyn Line) -> std::io::Result<()> {
        let now = self.slice_end;
        self.in_slice = false;
        // After a reset the board may say what its flash holds: the file must hold it, too.
        if self.print_reports(line) || now.is_multiple_of(FLASH_PERIOD) {
            self.keep_flash()?;
        }
        let sent: Vec<u8> = self.machine.world_mut().take_transmitted(PORT).into_iter().map(|(_, byte)| byte).collect();
        self.recorders.observer.sent(&sent);
        self.keep_truth(now)?;
        self.keep_pins()?;
        self.reader_gone = !line.send(&sent)?;
        self.pace(now);
        Ok(())
    }

    /// Writes what the files lack.
    pub fn finish(&mut self) -> std::io::Result<()> {
        self.recorders.truth.as_mut().map_or(Ok(()), TruthFile::finish)?;
        self.recorders.pins.as_mut().map_or(Ok(()), |pins| pins.finish(self.slice_end))?;
        self.keep_flash()
    }

    /// The board, for a debugger.
    pub fn machine(&mut self) -> &mut Machine<WiredRig> {
        &mut self.machine
    }

    /// GDB's description of the board's registers.
    pub fn debugger_description(&self) -> &'static str {
        self.machine.debugger_description()
    }

    /// The flag that Ctrl-C sets.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Continues after a debugger had stopped the board: real time is counted from now.
    pub fn resume(&mut self) {
        let passed = Duration::from_secs_f64(self.machine.seconds());
        self.began = Instant::now().checked_sub(passed).unwrap_or_else(Instant::now);
    }

    fn keep_flash(&mut self) -> std::io::Result<()> {
        self.recorders.flash.as_mut().map_or(Ok(()), |flash| flash.keep(&self.machine))
    }

    fn keep_truth(&mut self, now: Cycles) -> std::io::Result<()> {
        self.recorders.truth.as_mut().map_or(Ok(()), |truth| truth.write(now, self.machine.world_mut()))
    }

    fn keep_pins(&mut self) -> std::io::Result<()> {
        let changes = self.machine.take_pin_changes();
        self.recorders.pins.as_mut().map_or(Ok(()), |pins| pins.write(&changes))
    }

    /// True after Ctrl-C, without a reader, with a verdict, or with nothing left to run.
    fn is_over(&mut self) -> bool {
        let is_ended = self.stop.load(Ordering::Relaxed) || self.reader_gone;
        is_ended || self.recorders.observer.verdict().is_some() || self.is_locked_up_for_good()
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
    fn print_reports(&mut self, line: &mut dyn Line) -> bool {
        for report in self.machine.reports() {
            line.end_line();
            eprintln!("{report}");
            self.recorders.observer.reported();
        }
        for reset in &self.machine.resets()[self.resets_printed..] {
            line.end_line();
            eprintln!("{:.6} s: reset: {:?}", seconds(reset.at), reset.cause);
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
        match self.recorders.observer.final_verdict() {
            Verdict::Reached if machine.locked_up() => ExitCode::FAILURE,
            Verdict::Reached => ExitCode::SUCCESS,
            Verdict::Failed(reason) => {
                eprintln!("failed: {reason}");
                ExitCode::FAILURE
            }
        }
    }
}

fn seconds(cycles: Cycles) -> f64 {
    cycles as f64 / CYCLES_PER_SECOND as f64
}
