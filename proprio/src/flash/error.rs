//! Why a board is not flashed.

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use crate::link::{LinkError, Mismatch};

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

impl FlashError {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::NoSource(_) => "run it in the folder of the source, or name that with --source",
            Self::Port(LinkError::NoDue) => "plug it in by its programming port, or name another port with --port",
            Self::Port(error) | Self::Unheard(error) => error.remedy(),
            Self::Missing(program) | Self::Start { program, .. } => install(program),
            Self::NoObjcopy(_) => {
                "let rustup install the pinned toolchain: `rustup toolchain install` in the source's folder"
            }
            Self::Failed { program, .. } => look(program),
            Self::Temporary(_) => "make room, or let TMPDIR name a folder that can be written to",
            Self::Silent { .. } => "press RESET, then `proprio status`; docs/FLASHING.md, Trouble",
            Self::OtherTable { .. } => "see that the probe and the port are of one board, and flash again",
            Self::Other(_) => {
                "give this release's source with --source, and see that the probe and the port are of one board"
            }
        }
    }
}

fn install(program: &str) -> &'static str {
    match program {
        "bossac" => {
            "install BOSSA 1.9 (Debian, Ubuntu: apt install bossa-cli; https://github.com/shumatech/BOSSA), or plug in a \
             debug probe and install probe-rs (https://probe.rs)"
        }
        "probe-rs" => "install it again (https://probe.rs)",
        _ => "install Rust by rustup (https://rustup.rs)",
    }
}

fn look(program: &str) -> &'static str {
    match program {
        "bossac" => {
            "close what has the port open; docs/FLASHING.md, Trouble, tells what each of its errors means. The flash may be \
             erased, which flashing again mends"
        }
        "probe-rs" => "check the probe's cable and the board's supply; docs/FLASHING.md, Trouble",
        _ => "what it says above tells why; `rustup target add thumbv7m-none-eabi` if the target is missing",
    }
}
