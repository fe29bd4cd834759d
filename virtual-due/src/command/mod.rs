//! The command line, and the run that it starts.

mod arm_file;
mod error;
mod fault_injection;
mod flash_file;
mod gdb;
mod gdb_connection;
mod observation;
mod pins_file;
#[cfg(unix)]
mod pty;
mod run;
mod stdio;
mod truth_file;

use clap::{Parser, Subcommand, ValueEnum};
use error::Error;
use fault_injection::FaultInjector;
use flash_file::FlashFile;
use observation::{Expectations, Observer};
use pins_file::PinsFile;
use rig_twin::Scenario;
use run::{Line, Recorders, Run};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use truth_file::TruthFile;
use virtual_due::model::Pin;
use virtual_due::{Machine, arduino_pins, rig::WiredRig};

/// An emulated Arduino Due with the simulated arm on its pins.
#[derive(Debug, Parser)]
#[command(version)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a firmware. Reports, resets and a summary go to stderr.
    ///
    /// Exit status: 0 at the end of the run, 1 if the core locked up and nothing reset it or if the run has failed by
    /// `--until`, `--fail-on` or `--strict`, 2 if there is no such firmware.
    Run(Arguments),
}

#[derive(Debug, clap::Args)]
struct Arguments {
    /// The firmware: an ELF file, as linked for the Due's flash.
    ///
    /// Cargo leaves it as target/thumbv7m-none-eabi/PROFILE/NAME; the Arduino tools as NAME.ino.elf, next to the .bin (with
    /// `arduino-cli compile --fqbn arduino:sam:arduino_due_x_dbg --output-dir DIR`, in DIR).
    firmware: PathBuf,
    /// Motion of the arm until the firmware drives its regulators.
    #[arg(long, default_value = "1", value_parser = scenario)]
    scenario: Scenario,
    /// Seed of the arm's motion and the sensors' noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Arm description or table of the simulated arm: its segments, their lengths, and the pins in `[board]`; without it the
    /// reference arm in its reference wiring.
    #[arg(long, value_name = "ARM.toml")]
    arm: Option<PathBuf>,
    /// File of the chip's flash, 512 KiB, kept between runs; the firmware is written over it. Made if there is none.
    #[arg(long, value_name = "FILE")]
    flash: Option<PathBuf>,
    /// File of faults: lines of `SECONDS FAULT` or `SECONDS+DURATION FAULT`, such as `12.5 imu3:reset`.
    #[arg(long, value_name = "FILE")]
    faults: Option<PathBuf>,
    /// Virtual seconds to run; without it the run lasts until Ctrl-C.
    #[arg(long, value_parser = seconds)]
    seconds: Option<f64>,
    /// As fast as possible, or no faster than real time.
    #[arg(long, value_enum, default_value = "max")]
    speed: Speed,
    /// Connection of the programming port.
    #[arg(long, value_enum, default_value = "stdio")]
    serial: Serial,
    /// File of the twin's truth, a CSV with a row every 10 ms: true pose of each segment's end, set-points of the regulators.
    #[arg(long, value_name = "FILE.csv")]
    truth: Option<PathBuf>,
    /// File of every pin's changes, a VCD for PulseView or GTKWave; the pins have their Arduino names. Bytes of serial ports,
    /// I²C and SPI are not shown as bits.
    #[arg(long, value_name = "FILE.vcd")]
    pins: Option<PathBuf>,
    /// Wire between two pins, by their Arduino names; may be given more than once.
    #[arg(long, value_name = "PIN=PIN", value_parser = wire)]
    wire: Vec<[Pin; 2]>,
    /// Wait for GDB at this port of this computer, or at an address with a port, before the first instruction. Give GDB the
    /// same ELF file and `target remote localhost:PORT`.
    #[arg(long, value_name = "PORT", value_parser = gdb_address)]
    gdb: Option<SocketAddr>,
    #[command(flatten)]
    expectations: Expectations,
}

/// Pace of virtual time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Speed {
    /// As fast as possible.
    Max,
    /// No faster than real time.
    Real,
}

/// Connection of the programming port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Serial {
    /// This process' input and output. A file is read at the port's baud rate in virtual time.
    Stdio,
    /// A pseudo-terminal, whose path is printed. Opening it resets the board, as it does on a Due. Lines on the standard
    /// input inject faults: `imu3:reset`, `sda:held`, `clear sda:held`, `unplug bend2a`.
    #[cfg(unix)]
    Pty,
}

impl Cli {
    /// Executes the command.
    ///
    /// # Errors
    ///
    /// [`Error`] if the firmware, the arm's file or the serial port cannot be opened.
    pub fn execute(self) -> Result<ExitCode, Error> {
        let Command::Run(arguments) = self.command;
        let rig = arm_file::rig(arguments.arm.as_deref(), arguments.scenario, arguments.seed)?;
        let mut machine = machine(&arguments.firmware, rig)?;
        let flash = arguments.flash.map(|path| {
            let shown = path.display().to_string();
            FlashFile::load(path, &mut machine).map_err(|error| Error::Flash { path: shown, error })
        });
        let truth = arguments.truth.map(|path| {
            let shown = path.display().to_string();
            TruthFile::create(&path, machine.world()).map_err(|error| Error::Truth { path: shown, error })
        });
        let pins = arguments.pins.map(|path| {
            machine.record_pins();
            let shown = path.display().to_string();
            PinsFile::create(&path).map_err(|error| Error::Pins { path: shown, error })
        });
        for [first, second] in arguments.wire {
            machine.connect(first, second);
        }
        let observer = Observer::new(&arguments.expectations);
        let (flash, truth, pins) = (flash.transpose()?, truth.transpose()?, pins.transpose()?);
        let recorders = Recorders { flash, truth, pins, observer };
        let faults = arguments.faults.map(|path| FaultInjector::of_file(&path, &machine)).transpose()?;
        let mut faults = faults.unwrap_or_default();
        let paced = arguments.speed == Speed::Real;
        let mut run = Run::new(machine, recorders, arguments.seconds, paced)?;
        let mut drive = |line: &mut dyn Line, inject: &mut dyn FnMut(&mut Machine<WiredRig>)| match arguments.gdb {
            Some(address) => gdb::debug(&mut run, line, inject, address).map_err(|error| Error::Gdb { address, error }),
            None => run.execute(line, inject).map_err(Error::Serial),
        };
        match arguments.serial {
            Serial::Stdio => drive(&mut stdio::Stdio::new()?, &mut |machine| faults.apply(machine))?,
            #[cfg(unix)]
            Serial::Pty => {
                let mut pty = pty::Pty::new()?;
                eprintln!("serial port: {}", pty.path());
                let mut faults = faults.reading_stdin();
                drive(&mut pty, &mut |machine| faults.apply(machine))?;
            }
        }
        Ok(run.summary())
    }
}

fn machine(path: &Path, rig: WiredRig) -> Result<Machine<WiredRig>, Error> {
    let shown = || path.display().to_string();
    let elf = std::fs::read(path).map_err(|error| Error::Firmware { path: shown(), error })?;
    Machine::new(&elf, rig).map_err(|error| Error::Elf { path: shown(), error })
}

fn scenario(text: &str) -> Result<Scenario, String> {
    match text {
        "1" => Ok(Scenario::FreeSwing),
        "2" => Ok(Scenario::Push),
        "3" => Ok(Scenario::Obstacle),
        _ => Err("expected 1, 2 or 3".to_owned()),
    }
}

fn gdb_address(text: &str) -> Result<SocketAddr, String> {
    match text.parse::<u16>() {
        Ok(port) => Ok((Ipv4Addr::LOCALHOST, port).into()),
        Err(_) => text.parse().map_err(|_| "expected a port, such as 3333, or an address with a port".to_owned()),
    }
}

fn wire(text: &str) -> Result<[Pin; 2], String> {
    let pin = |name: &str| {
        let expected = "expected D0 to D53, A0 to A11, DAC0, DAC1, SDA1, SCL1, MISO, MOSI, SCK or SS0";
        arduino_pins::named(name).ok_or_else(|| format!("no pin `{name}`: {expected}"))
    };
    let (first, second) = text.split_once('=').ok_or("expected two pins, such as D7=D2")?;
    match [pin(first)?, pin(second)?] {
        [first, second] if first == second => Err("expected two different pins".to_owned()),
        pins => Ok(pins),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err("expected a number of seconds from 0 to 1e9".to_owned()),
    }
}
