//! Errors of flashing.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use firmware_image::ImageError;
use proprio_link::table::TransferError;
use proprio_link::{LinkError, Mismatch};

/// An error that keeps a board from being flashed or verified.
#[derive(Debug, thiserror::Error)]
pub enum FlashError {
    /// The firmware cannot be read.
    #[error("{}: the firmware cannot be read: {source}", path.display())]
    Firmware {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file is not a firmware for the Due.
    #[error("{}: {source}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: ImageError,
    },
    /// The folder does not hold the firmware's source.
    #[error("{}: is not the source of proprio, it has no firmware/Cargo.toml", .0.display())]
    NoSource(PathBuf),
    /// No port for flashing and verifying.
    #[error(transparent)]
    Port(LinkError),
    /// There is neither a probe nor bossac.
    #[error(
        "no debug probe is found by probe-rs, and the program bossac is neither on the PATH nor, as version 1.6 or 1.7, in {}",
        .0.display()
    )]
    NoFlasher(PathBuf),
    /// A program is not installed.
    #[error("the program {0} is not on the PATH")]
    Missing(String),
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
    /// The image for bossac cannot be written.
    #[error("no temporary file can be written: {0}")]
    Temporary(io::Error),
    /// The board cannot be reset into its boot loader.
    #[error("{port}: cannot be opened at 1200 Bd: {source}")]
    Touch {
        /// Its name.
        port: String,
        /// The system's reason.
        source: serialport::Error,
    },
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
    /// The board's `Hello` has another firmware.
    #[error("flashed, but {0}")]
    Other(Mismatch),
    /// The table was not stored.
    #[error("flashed, but the table is not on the board: {0}")]
    Table(TransferError),
}
