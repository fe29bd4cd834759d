//! Errors of the command line.

use std::net::SocketAddr;

use calibration_tables::FileError;
use rig_twin::{FaultError, LayoutError, MAX_SEGMENTS};
use virtual_due::ImageError;

/// Reason why the firmware cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The firmware cannot be read.
    #[error("{path}: {error}; build the firmware first, and give the path of its ELF file")]
    Firmware {
        /// The path as it was given.
        path: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// It is not a firmware for the Due.
    #[error("{path}: {error}")]
    Elf {
        /// The path as it was given.
        path: String,
        /// The reason.
        error: ImageError,
    },
    /// The arm's file is no arm description and no table.
    #[error("{path}: {error}; --arm takes the arm's description or table")]
    Arm {
        /// The path as it was given.
        path: String,
        /// The reason.
        error: FileError,
    },
    /// The arm is larger than the board has room for.
    #[error("{path}: {error}; simulate an arm of 1 to {MAX_SEGMENTS} segments")]
    Layout {
        /// The path as it was given.
        path: String,
        /// The reason.
        error: LayoutError,
    },
    /// The file of the flash cannot be read or written.
    #[error("{path}: {error}; --flash takes a file of 512 KiB, or the name of a new one")]
    Flash {
        /// The path as it was given.
        path: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// The file of the truth cannot be made.
    #[error("{path}: {error}; --truth takes the name of a file to write")]
    Truth {
        /// The path as it was given.
        path: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// The file of the pins' changes cannot be made.
    #[error("{path}: {error}; --pins takes the name of a file to write")]
    Pins {
        /// The path as it was given.
        path: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// The debugger's connection, or the run under the debugger.
    #[error("GDB at {address}: {error}")]
    Gdb {
        /// Address at which the debugger is awaited.
        address: SocketAddr,
        /// The system's error.
        error: std::io::Error,
    },
    /// The file of faults cannot be read.
    #[error("{path}: {error}; --faults takes a file of lines such as `12.5 imu3:reset`")]
    FaultFile {
        /// The path as it was given.
        path: String,
        /// The system's error.
        error: std::io::Error,
    },
    /// A line of the file of faults is wrong.
    #[error("{path}, line {line}: {error}; docs/reference/faults.md lists all faults")]
    Fault {
        /// The path as it was given.
        path: String,
        /// The line, counted from 1.
        line: usize,
        /// The reason.
        error: FaultError,
    },
    /// The serial port cannot be opened.
    #[error("serial port: {0}")]
    Serial(#[from] std::io::Error),
}
