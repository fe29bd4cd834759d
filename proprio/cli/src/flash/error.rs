//! Errors of flashing.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use proprio_link::{LinkError, Mismatch};

/// An error that keeps a board from being flashed or verified.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    /// The folder does not hold the firmware's source.
    #[error("{}: is not the source of proprio, it has no firmware/Cargo.toml", .0.display())]
    NoSource(PathBuf),
    /// No port for flashing and verifying.
    #[error(transparent)]
    Port(LinkError),
    /// A program is not installed.
    #[error("the program {0} is not on the PATH")]
    Missing(String),
    /// The pinned toolchain's objcopy is not installed.
    #[error("{}: does not exist", .0.display())]
    NoObjcopy(PathBuf),
    /// A program does not start.
    #[error("{program} cannot be started: {source}")]
    Start {
        /// The program.
        program: String,
        /// The system's reason.
        source: io::Error,
    },
    /// A command has failed; it has printed the reason.
    #[error("{command}: has failed ({status})")]
    Failed {
        /// The program, by which the remedy is selected.
        program: String,
        /// The whole command.
        command: String,
        /// Its exit status.
        status: ExitStatus,
    },
    /// There is no room for the image.
    #[error("no temporary folder can be made: {0}")]
    Temporary(io::Error),
    /// The board sends no `Hello`.
    #[error("flashed, but no Hello came on {port} within {seconds} s")]
    Silent {
        /// The line's name.
        port: String,
        /// Time of waiting, s.
        seconds: u64,
    },
    /// The line is gone.
    #[error("flashed, but not verified: {0}")]
    Unheard(LinkError),
    /// The board's `Hello` has another table.
    #[error("flashed, but the board has another table (of arm \"{arm}\", checksum {board:08x}) than {given:08x}")]
    OtherTable {
        /// Name of the arm that the board's table is for.
        arm: String,
        /// Its checksum.
        board: u32,
        /// Checksum of the table that was flashed.
        given: u32,
    },
    /// The board's `Hello` has another firmware.
    #[error("flashed, but {0}")]
    Other(Mismatch),
}
