//! Errors of the link to a board.

use std::io;
use std::path::PathBuf;

use super::requests::RequestError;

/// An error that keeps a board from being reached.
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
    /// The Due was unplugged.
    #[error("the Due is not plugged in")]
    Gone,
    /// The port cannot be opened.
    #[error("{port}: cannot be opened: {source}")]
    Open {
        /// Its name.
        port: String,
        /// The system's reason.
        source: serialport::Error,
    },
    /// There is no program that emulates a Due.
    #[error(
        "the program virtual-due is neither in the folder of proprio nor on the PATH, nor does PROPRIO_VIRTUAL_DUE name it"
    )]
    NoVirtualDue,
    /// The emulated Due has no firmware to run.
    #[error("{}: there is no such firmware for the emulated Due to run", .0.display())]
    NoFirmware(PathBuf),
    /// The program that emulates a Due does not start.
    #[error("{}: cannot be started: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The flash of the emulated Due cannot be written.
    #[error("the flash of the emulated Due cannot be written: {0}")]
    Flash(io::Error),
    /// The link's thread does not start.
    #[error("no thread can be started: {0}")]
    Thread(io::Error),
    /// The line is gone.
    #[error("{0}")]
    Ended(String),
    /// No valid `Hello` and `Health` came from the board.
    #[error("{port}: no Hello and Health within {seconds} s; {received} frames were read, {damaged} were damaged")]
    Silent {
        /// The line's name.
        port: String,
        /// Time of waiting, s.
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
