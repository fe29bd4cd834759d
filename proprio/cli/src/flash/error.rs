//! Why a board is not flashed.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use proprio_link::{LinkError, Mismatch};

/// What keeps the firmware from a board.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    /// The folder does not hold the firmware's source.
    #[error("{}: is not the source of proprio, it has no firmware/Cargo.toml", .0.display())]
    NoSource(PathBuf),
    /// No port to flash over, or to hear the board on.
    #[error(transparent)]
    Port(LinkError),
    /// A program is not there.
    #[error("the program {0} is not on the PATH")]
    Missing(String),
    /// The pinned toolchain's objcopy is not there.
    #[error("{}: is not there", .0.display())]
    NoObjcopy(PathBuf),
    /// A program does not start.
    #[error("{program} cannot be started: {source}")]
    Start {
        /// The program.
        program: String,
        /// What the system says.
        source: io::Error,
    },
    /// A command has failed, and said why.
    #[error("{command}: has failed ({status})")]
    Failed {
        /// The program, which tells what to look at.
        program: String,
        /// The whole command.
        command: String,
        /// How it ended.
        status: ExitStatus,
    },
    /// There is no room for the image.
    #[error("no temporary folder can be made: {0}")]
    Temporary(io::Error),
    /// The board does not say that it has the firmware.
    #[error("flashed, but {port} says no Hello within {seconds} s")]
    Silent {
        /// The line's name.
        port: String,
        /// How long was waited.
        seconds: u64,
    },
    /// The line is gone.
    #[error("flashed, but not heard: {0}")]
    Unheard(LinkError),
    /// The board says that it has another table.
    #[error("flashed, but the board has another table (of arm \"{arm}\", checksum {board:08x}) than {given:08x}")]
    OtherTable {
        /// Name of the arm that the board's table is for.
        arm: String,
        /// Its checksum.
        board: u32,
        /// Checksum of the table that was flashed.
        given: u32,
    },
    /// The board says that it has another firmware.
    #[error("flashed, but {0}")]
    Other(Mismatch),
}
