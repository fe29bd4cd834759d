//! A GDB server: the debugger stops the board, steps it, and reads and writes it.

use std::io::{self, ErrorKind};
use std::marker::PhantomData;
use std::net::{SocketAddr, TcpListener};

use gdbstub::arch::{Arch, Registers};
use gdbstub::common::Signal;
use gdbstub::conn::ConnectionExt;
use gdbstub::stub::run_blocking::{BlockingEventLoop, Event, WaitForStopReasonError};
use gdbstub::stub::{DisconnectReason, GdbStub, GdbStubError, SingleThreadStopReason};
use gdbstub::target::ext::base::BaseOps;
use gdbstub::target::ext::base::singlethread::{
    SingleThreadBase, SingleThreadResume, SingleThreadResumeOps, SingleThreadSingleStep, SingleThreadSingleStepOps,
};
use gdbstub::target::ext::breakpoints::{Breakpoints, BreakpointsOps, SwBreakpoint, SwBreakpointOps};
use gdbstub::target::ext::monitor_cmd::{ConsoleOutput, MonitorCmd, MonitorCmdOps, outputln};
use gdbstub::target::ext::target_description_xml_override::{
    TargetDescriptionXmlOverride, TargetDescriptionXmlOverrideOps,
};
use gdbstub::target::{Target, TargetError, TargetResult};
use virtual_due::{Machine, WiredRig};

use super::gdb_connection::GdbConnection;
use super::run::{Line, Progress, Run};

/// r0 to r15, xPSR, MSP, PSP, PRIMASK, BASEPRI, FAULTMASK and CONTROL, as the board's description lists them.
const REGISTERS: usize = 23;
const PC: usize = 15;
/// Registers of the core itself.
const CORE: std::ops::Range<u32> = 0xE000_0000..0xE010_0000;

/// Waits for GDB at an address, and runs the board under its control; after a detach, to its end.
///
/// # Errors
/// Those of the network and of the run.
pub fn debug(
    run: &mut Run,
    line: &mut dyn Line,
    inject: &mut dyn FnMut(&mut Machine<WiredRig>),
    address: SocketAddr,
) -> io::Result<()> {
    let listener = TcpListener::bind(address)?;
    eprintln!("waiting for GDB: target remote {}", listener.local_addr()?);
    let Some(connection) = GdbConnection::accept(&listener, run.stop_flag())? else { return Ok(()) };
    let mut board = Board { run, line, inject, steps: false };
    let ended = GdbStub::new(connection).run_blocking::<Loop>(&mut board);
    match ended {
        Ok(DisconnectReason::Disconnect) => board.run.machine().remove_breakpoints(),
        Ok(_) => return board.run.finish(),
        Err(error) => return Err(io_error(error)),
    }
    eprintln!("GDB has left: the board runs on");
    board.run.execute(board.line, board.inject)
}

fn io_error(error: GdbStubError<io::Error, io::Error>) -> io::Error {
    if error.is_connection_error() {
        return error.into_connection_error().map_or_else(|| ErrorKind::Other.into(), |(error, _)| error);
    }
    if error.is_target_error() {
        return error.into_target_error().unwrap_or_else(|| ErrorKind::Other.into());
    }
    io::Error::other(error.to_string())
}

/// The board as GDB's stub sees it.
struct Board<'a> {
    run: &'a mut Run,
    line: &'a mut dyn Line,
    inject: &'a mut dyn FnMut(&mut Machine<WiredRig>),
    /// GDB wants one instruction.
    steps: bool,
}

impl Board<'_> {
    /// Reads bytes of memory or of registers, up to the first that does not exist. A register is read once.
    fn read(&mut self, start: u32, data: &mut [u8]) -> usize {
        let machine = self.run.machine();
        if let Some(bytes) = machine.peek(start, data.len()) {
            data.copy_from_slice(&bytes);
            return data.len();
        }
        let mut word: Option<(u32, [u8; 4])> = None;
        for (index, byte) in data.iter_mut().enumerate() {
            let address = start.wrapping_add(index as u32);
            let base = address & !3;
            let bytes = match word {
                Some((at, bytes)) if at == base => bytes,
                _ => {
                    let value =
                        if CORE.contains(&base) { machine.peek_core(base) } else { machine.peek_peripheral(base) };
                    let Some(value) = value else { return index };
                    value.to_le_bytes()
                }
            };
            word = Some((base, bytes));
            *byte = bytes[address as usize & 3];
        }
        data.len()
    }

    /// Writes bytes of memory, or whole words of registers.
    fn write(&mut self, start: u32, data: &[u8]) -> bool {
        let machine = self.run.machine();
        if machine.poke(start, data) {
            return true;
        }
        let (words, rest) = data.as_chunks();
        rest.is_empty()
            && (start..).step_by(4).zip(words).all(|(address, word)| {
                let value = u32::from_le_bytes(*word);
                if CORE.contains(&address) {
                    machine.poke_core(address, value)
                } else {
                    machine.poke_peripheral(address, value)
                }
            })
    }
}

impl Target for Board<'_> {
    type Arch = CortexM3;
    type Error = io::Error;

    fn base_ops(&mut self) -> BaseOps<'_, CortexM3, io::Error> {
        BaseOps::SingleThread(self)
    }

    fn support_breakpoints(&mut self) -> Option<BreakpointsOps<'_, Self>> {
        Some(self)
    }

    fn support_monitor_cmd(&mut self) -> Option<MonitorCmdOps<'_, Self>> {
        Some(self)
    }

    fn support_target_description_xml_override(&mut self) -> Option<TargetDescriptionXmlOverrideOps<'_, Self>> {
        Some(self)
    }
}

impl SingleThreadBase for Board<'_> {
    fn read_registers(&mut self, registers: &mut CoreRegisters) -> TargetResult<(), Self> {
        for (number, value) in registers.0.iter_mut().enumerate() {
            *value = self.run.machine().register(number).ok_or(TargetError::NonFatal)?;
        }
        Ok(())
    }

    /// Writes those that differ: r13 is one of the two stack pointers, which are registers of their own.
    fn write_registers(&mut self, registers: &CoreRegisters) -> TargetResult<(), Self> {
        let machine = self.run.machine();
        for (number, value) in registers.0.iter().enumerate() {
            if machine.register(number) != Some(*value) && !machine.set_register(number, *value) {
                return Err(TargetError::NonFatal);
            }
        }
        Ok(())
    }

    fn read_addrs(&mut self, start: u32, data: &mut [u8]) -> TargetResult<usize, Self> {
        match self.read(start, data) {
            0 => Err(TargetError::NonFatal),
            count => Ok(count),
        }
    }

    fn write_addrs(&mut self, start: u32, data: &[u8]) -> TargetResult<(), Self> {
        if self.write(start, data) { Ok(()) } else { Err(TargetError::NonFatal) }
    }

    fn support_resume(&mut self) -> Option<SingleThreadResumeOps<'_, Self>> {
        Some(self)
    }
}

impl SingleThreadResume for Board<'_> {
    fn resume(&mut self, _signal: Option<Signal>) -> io::Result<()> {
        self.steps = false;
        self.run.resume();
        Ok(())
    }

    fn support_single_step(&mut self) -> Option<SingleThreadSingleStepOps<'_, Self>> {
        Some(self)
    }
}

impl SingleThreadSingleStep for Board<'_> {
    fn step(&mut self, _signal: Option<Signal>) -> io::Result<()> {
        self.steps = true;
        self.run.resume();
        Ok(())
    }
}

impl Breakpoints for Board<'_> {
    fn support_sw_breakpoint(&mut self) -> Option<SwBreakpointOps<'_, Self>> {
        Some(self)
    }
}

impl SwBreakpoint for Board<'_> {
    fn add_sw_breakpoint(&mut self, address: u32, _kind: usize) -> TargetResult<bool, Self> {
        Ok(self.run.machine().add_breakpoint(address))
    }

    fn remove_sw_breakpoint(&mut self, address: u32, _kind: usize) -> TargetResult<bool, Self> {
        Ok(self.run.machine().remove_breakpoint(address))
    }
}

impl MonitorCmd for Board<'_> {
    fn handle_monitor_cmd(&mut self, command: &[u8], mut out: ConsoleOutput<'_>) -> io::Result<()> {
        if command.starts_with(b"reset") {
            self.run.machine().press_reset();
            outputln!(out, "the board is at its reset; type `maintenance flush register-cache` to see it");
        } else {
            outputln!(out, "commands: `monitor reset` resets the board");
        }
        Ok(())
    }
}

impl TargetDescriptionXmlOverride for Board<'_> {
    fn target_description_xml(
        &self,
        annex: &[u8],
        offset: u64,
        length: usize,
        buffer: &mut [u8],
    ) -> TargetResult<usize, Self> {
        if annex != b"target.xml" {
            return Err(TargetError::NonFatal);
        }
        let text = self.run.debugger_description().as_bytes();
        let rest = &text[(offset as usize).min(text.len())..];
        let piece = &rest[..length.min(rest.len()).min(buffer.len())];
        buffer[..piece.len()].copy_from_slice(piece);
        Ok(piece.len())
    }
}

/// The core's registers as GDB numbers them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CoreRegisters([u32; REGISTERS]);

impl Registers for CoreRegisters {
    type ProgramCounter = u32;

    fn pc(&self) -> u32 {
        self.0[PC]
    }

    fn gdb_serialize(&self, mut write_byte: impl FnMut(Option<u8>)) {
        self.0.iter().flat_map(|value| value.to_le_bytes()).for_each(|byte| write_byte(Some(byte)));
    }

    fn gdb_deserialize(&mut self, bytes: &[u8]) -> Result<(), ()> {
        let (words, rest) = bytes.as_chunks();
        let words = <[[u8; 4]; REGISTERS]>::try_from(words).map_err(|_| ())?;
        self.0 = words.map(u32::from_le_bytes);
        if rest.is_empty() { Ok(()) } else { Err(()) }
    }
}

/// The architecture of the board's core.
pub enum CortexM3 {}

impl Arch for CortexM3 {
    type Usize = u32;
    type Registers = CoreRegisters;
    type BreakpointKind = usize;
    type RegId = ();
}

/// The stub's loop: the board runs in slices, and the connection is polled between them.
struct Loop<'a>(PhantomData<&'a ()>);

impl<'a> BlockingEventLoop for Loop<'a> {
    type Target = Board<'a>;
    type Connection = GdbConnection;
    type StopReason = SingleThreadStopReason<u32>;

    fn wait_for_stop_reason(
        board: &mut Board<'a>,
        connection: &mut GdbConnection,
    ) -> Result<Event<Self::StopReason>, WaitForStopReasonError<io::Error, io::Error>> {
        loop {
            if connection.peek().map_err(WaitForStopReasonError::Connection)?.is_some() {
                return connection.read().map(Event::IncomingData).map_err(WaitForStopReasonError::Connection);
            }
            let Board { run, line, inject, steps } = board;
            let progress = if *steps { run.step(*line, *inject) } else { run.advance(*line, *inject) };
            let reason = match progress.map_err(WaitForStopReasonError::Target)? {
                Progress::Running => continue,
                Progress::Stepped => SingleThreadStopReason::DoneStep,
                Progress::Breakpoint => SingleThreadStopReason::SwBreak(()),
                Progress::Over => SingleThreadStopReason::Exited(0),
            };
            return Ok(Event::TargetStopped(reason));
        }
    }

    fn on_interrupt(_board: &mut Board<'a>) -> io::Result<Option<Self::StopReason>> {
        Ok(Some(SingleThreadStopReason::Signal(Signal::SIGINT)))
    }
}
