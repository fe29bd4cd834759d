//! Why there is no link to a board.

use std::io;
use std::path::PathBuf;

use super::requests::RequestError;

/// What keeps a board from being reached.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The system does not list its ports.
    #[error("the serial ports cannot be listed: {0}")]
    List(serialport::Error),
    /// No Due is plugged in.
    #[error("no Arduino Due is plugged in")]
    NoDue,
    /// More than one is.
    #[error("there are several Arduino Dues: {}", .0.join(", "))]
    SeveralDues(Vec<String>),
    /// The Due that was there is not.
    #[error("the Due is not plugged in")]
    Gone,
    /// The port cannot be opened.
    #[error("{port}: cannot be opened: {source}")]
    Open {
        /// Its name.
        port: String,
        /// What the system says.
        source: serialport::Error,
    },
    /// There is no program that emulates a Due.
    #[error("the program virtual-due is neither beside proprio nor on the PATH, nor does PROPRIO_VIRTUAL_DUE name it")]
    NoVirtualDue,
    /// The emulated Due has no firmware to run.
    #[error("{}: there is no such firmware for the emulated Due to run", .0.display())]
    NoFirmware(PathBuf),
    /// The program that emulates a Due does not start.
    #[error("{}: cannot be started: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The link's thread does not start.
    #[error("no thread can be started: {0}")]
    Thread(io::Error),
    /// The line is gone.
    #[error("{0}")]
    Ended(String),
    /// The board says nothing that is understood.
    #[error("{port}: no Hello and Health within {seconds} s; {received} frames were read, {damaged} were damaged")]
    Silent {
        /// The line's name.
        port: String,
        /// How long was waited.
        seconds: u64,
        /// Whole frames.
        received: u32,
        /// Damaged ones.
        damaged: u32,
    },
    /// A request was not done.
    #[error(transparent)]
    Request(#[from] RequestError),
}

impl LinkError {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::List(_) => "name the port with --port",
            Self::NoDue => "plug it in by its programming port, name another port with --port, or use --virtual",
            Self::SeveralDues(_) => "name one with --port; `proprio ports` lists them",
            Self::Gone => "plug it in again",
            Self::Open { source, .. } => open_remedy(source),
            Self::NoVirtualDue => "build it: cargo build --ignore-rust-version -p virtual-due",
            Self::NoFirmware(_) => {
                "build it: cargo build --release -p firmware --target thumbv7m-none-eabi, or name one with --firmware"
            }
            Self::Start { .. } => "build it again, or let PROPRIO_VIRTUAL_DUE name it",
            Self::Thread(_) => "close other programs",
            Self::Ended(_) => "look at what the board or its program says",
            Self::Silent { .. } => {
                "check that the firmware is on the board (docs/FLASHING.md) and that this is its programming port"
            }
            Self::Request(RequestError::Refused(_)) => "do what the board asks for first",
            Self::Request(_) => "try again; `proprio status` tells how the board is",
        }
    }
}

fn open_remedy(source: &serialport::Error) -> &'static str {
    match source.kind() {
        serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) if cfg!(target_os = "linux") => {
            "join the group that the port belongs to (sudo usermod -aG dialout $USER), and log in again"
        }
        serialport::ErrorKind::NoDevice => {
            "check the name (`proprio ports` lists them), and close other programs that have the port open"
        }
        _ => "check the name and the cable, and close other programs that have the port open",
    }
}
