//! The emulated Due as a line: the program `virtual-due`, with pipes as its serial port.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use board_table::STORE_BYTES;
use tempfile::NamedTempFile;

use super::{LinkError, Source, Transport};
use crate::companions::{firmware_path, virtual_due_path};
use crate::table::StoredTable;

/// Longest wait of a read, as on a serial port.
const WAIT: Duration = Duration::from_millis(10);

/// Number of the program's last lines of output that an error shows.
const LINES: usize = 5;

/// A run of the emulated Due.
#[derive(Debug, Clone)]
pub struct VirtualDue {
    /// ELF of the firmware; `None`: beside the program, or where cargo leaves it ([`firmware_path`]).
    pub firmware: Option<PathBuf>,
    /// Scenario of the arm until the firmware drives its regulators: 1 to 3.
    pub scenario: u8,
    /// Seed of the arm's motion and the sensors' noise.
    pub seed: u64,
    /// Arm description or table of the simulated arm; `None`: the reference arm.
    pub arm: Option<PathBuf>,
    /// Content of its flash.
    pub flash: Flash,
}

/// Content of an emulated board's flash beside the firmware.
#[derive(Debug, Clone)]
pub enum Flash {
    /// This table, in a file that is removed at the end.
    Table(StoredTable),
    /// That of a file, which is kept; empty if there is none yet.
    File(PathBuf),
}

/// Size of the chip's flash, bytes.
const FLASH_BYTES: usize = 512 * 1024;

impl Flash {
    /// Its file, and that again where it is temporary.
    fn file(&self) -> Result<(PathBuf, Option<NamedTempFile>), LinkError> {
        match self {
            Self::File(path) => Ok((path.clone(), None)),
            Self::Table(table) => {
                // The store is at the end of the flash.
                let mut content = vec![0xFF; FLASH_BYTES - STORE_BYTES];
                content.extend(table.store().map_err(|error| LinkError::Flash(io::Error::other(error)))?);
                let mut file = NamedTempFile::new().map_err(LinkError::Flash)?;
                file.write_all(&content).map_err(LinkError::Flash)?;
                Ok((file.path().to_owned(), Some(file)))
            }
        }
    }
}

impl Source for VirtualDue {
    fn open(&mut self) -> Result<(String, Box<dyn Transport>), LinkError> {
        let program = virtual_due_path().ok_or(LinkError::NoVirtualDue)?;
        let firmware = self.firmware.clone().unwrap_or_else(firmware_path);
        if !firmware.is_file() {
            return Err(LinkError::NoFirmware(firmware));
        }
        let mut command = Command::new(&program);
        command.arg("run").arg(&firmware).args(["--serial", "stdio", "--speed", "real"]);
        command.args(["--scenario", &self.scenario.to_string(), "--seed", &self.seed.to_string()]);
        if let Some(arm) = &self.arm {
            command.arg("--arm").arg(arm);
        }
        let (flash, temporary) = self.flash.file()?;
        command.arg("--flash").arg(flash);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        detach(&mut command);
        let child = command.spawn().map_err(|source| LinkError::Start { program, source })?;
        Ok(("virtual Due".to_owned(), Box::new(Running::new(child, temporary)?)))
    }

    fn can_reconnect(&self) -> bool {
        false
    }
}

/// Ctrl-C is for this program, which then ends the other.
#[cfg(unix)]
fn detach(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

/// Ctrl-C is for this program, which then ends the other.
#[cfg(windows)]
fn detach(command: &mut Command) {
    const CREATE_NEW_PROCESS_GROUP: u32 = 0x200;
    std::os::windows::process::CommandExt::creation_flags(command, CREATE_NEW_PROCESS_GROUP);
}

/// The program while it runs.
struct Running {
    child: Child,
    input: ChildStdin,
    output: Receiver<Vec<u8>>,
    /// Bytes that did not fit the reader's buffer.
    rest: Vec<u8>,
    last_lines: LastLines,
    /// Its flash, where that is not kept.
    _flash: Option<NamedTempFile>,
}

impl Running {
    fn new(mut child: Child, flash: Option<NamedTempFile>) -> Result<Self, LinkError> {
        let missing = || LinkError::Ended("the virtual Due has no pipes".to_owned());
        let input = child.stdin.take().ok_or_else(missing)?;
        let output = pump(child.stdout.take().ok_or_else(missing)?)?;
        let last_lines = LastLines::read(child.stderr.take().ok_or_else(missing)?)?;
        Ok(Self { child, input, output, rest: Vec::new(), last_lines, _flash: flash })
    }

    fn ended(&mut self) -> io::Error {
        let status = self.child.wait().map_or_else(|error| error.to_string(), |status| status.to_string());
        io::Error::other(format!("the virtual Due has ended ({status}): {}", self.last_lines.text()))
    }
}

/// Reads its output in a thread of its own, as pipes of all systems can be read.
fn pump(mut output: ChildStdout) -> Result<Receiver<Vec<u8>>, LinkError> {
    let (sender, receiver) = channel();
    let work = move || {
        let mut buffer = [0; 4096];
        while let Ok(count @ 1..) = output.read(&mut buffer) {
            if sender.send(buffer[..count].to_vec()).is_err() {
                break;
            }
        }
    };
    std::thread::Builder::new().name("virtual-due output".to_owned()).spawn(work).map_err(LinkError::Thread)?;
    Ok(receiver)
}

/// The last lines of its standard error.
struct LastLines {
    lines: Arc<Mutex<VecDeque<String>>>,
    /// Reads them, and ends with the program.
    reader: Option<JoinHandle<()>>,
}

impl LastLines {
    /// Reads lines in a thread of its own.
    fn read(errors: ChildStderr) -> Result<Self, LinkError> {
        let lines = Arc::new(Mutex::new(VecDeque::new()));
        let shared = Arc::clone(&lines);
        let work = move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                let mut lines = shared.lock().unwrap_or_else(PoisonError::into_inner);
                if lines.len() == LINES {
                    lines.pop_front();
                }
                lines.push_back(line);
            }
        };
        let reader = std::thread::Builder::new().name("virtual-due errors".to_owned()).spawn(work);
        Ok(Self { lines, reader: Some(reader.map_err(LinkError::Thread)?) })
    }

    /// The lines of a program that has ended.
    fn text(&mut self) -> String {
        if let Some(reader) = self.reader.take() {
            // It has no result, and panics on nothing.
            let _ = reader.join();
        }
        let lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        lines.iter().map(String::as_str).collect::<Vec<_>>().join("; ")
    }
}

impl Transport for Running {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.rest.is_empty() {
            match self.output.recv_timeout(WAIT) {
                Ok(bytes) => self.rest = bytes,
                Err(RecvTimeoutError::Timeout) => return Ok(0),
                Err(RecvTimeoutError::Disconnected) => return Err(self.ended()),
            }
        }
        let count = self.rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.rest[..count]);
        self.rest.drain(..count);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self.input.write_all(bytes).and_then(|()| self.input.flush()) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Err(self.ended()),
            result => result,
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
