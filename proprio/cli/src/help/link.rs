//! Remedies of errors of the link to a board and its pressures.

use std::io;

use board_table::TableError;
use proprio_link::drive::DriveError;
use proprio_link::table::{TableImageError, TransferError};
use proprio_link::{LinkError, RequestError, TareError};

use super::Help;

impl Help for LinkError {
    fn help(&self) -> String {
        let help = match self {
            Self::List(_) => "name the port with --port",
            Self::NoDue => "plug it in by its programming port, name another port with --port, or use --virtual",
            Self::SeveralDues(_) => "name one with --port; `proprio ports` lists them",
            Self::Gone => "plug it in again",
            Self::Open { source, .. } => open_remedy(source),
            Self::NoVirtualDue => {
                "take proprio from its archive or its Python package, or build it: cargo virtual-due --version"
            }
            Self::NoFirmware(_) => {
                "put firmware.elf beside the program, name one with --firmware, or build it: cargo build --profile firmware -p firmware --target thumbv7m-none-eabi"
            }
            Self::Start { .. } => "build it again, or set PROPRIO_VIRTUAL_DUE to its path",
            Self::Flash(_) => "check the space and the permissions of the folder for temporary files",
            Self::Thread(_) => "close other programs",
            Self::Ended(_) => "see the messages of the board or its program",
            Self::Silent { .. } => {
                "check that the firmware is on the board (docs/how-to/flashing.md) and that this is its programming port"
            }
            Self::Request(RequestError::Refused(_)) => "remove the reason that the board gives, and try again",
            Self::Request(RequestError::Driven) => "end that, or vent the arm there, and try again",
            Self::Request(_) => "try again; `proprio status` shows the state of the board",
        };
        help.to_owned()
    }
}

/// The remedy of an error when a port is opened.
pub fn open_remedy(source: &serialport::Error) -> &'static str {
    match source.kind() {
        serialport::ErrorKind::Io(io::ErrorKind::PermissionDenied) if cfg!(target_os = "linux") => {
            "let `proprio ports --udev` give access to the port, or join its group (sudo usermod -aG dialout $USER) and log in again"
        }
        serialport::ErrorKind::NoDevice => {
            "check the name (`proprio ports` lists them), and close other programs that have the port open"
        }
        _ => "check the name and the cable, and close other programs that have the port open",
    }
}

impl Help for TableImageError {
    fn help(&self) -> String {
        match self {
            Self::File(error) => error.help(),
            Self::Segments(_) | Self::BendSensors(_) => {
                "a host alone can replay and monitor such an arm; the board needs a smaller one".to_owned()
            }
            Self::ReferencePins { .. } => {
                "give each segment its pins in a section `[board]` (docs/how-to/wiring.md)".to_owned()
            }
            Self::Table(TableError::Wiring(_)) => "correct the section `[board]` (docs/how-to/wiring.md)".to_owned(),
            Self::Table(_) => "give a table of a smaller arm".to_owned(),
            Self::Source(_) => "write the table again".to_owned(),
        }
    }
}

impl Help for TransferError {
    fn help(&self) -> String {
        let help = match self {
            Self::Link(error) => return error.help(),
            Self::NoState => "flash firmware of this version: `proprio flash`",
            Self::NoTable(_) => "store one with `proprio table push TABLE.toml`",
            Self::Damaged | Self::Source(_) => "try again; if it persists, store the table again",
            Self::OtherTable { .. } => "store the table again; `proprio table show` shows the board's",
        };
        help.to_owned()
    }
}

impl Help for TareError {
    fn help(&self) -> String {
        match self {
            Self::Moving(_) => "let it rest, or use --force".to_owned(),
            Self::Link(error) => error.help(),
        }
    }
}

impl Help for DriveError {
    fn help(&self) -> String {
        let help = match self {
            Self::Regulators { .. } => {
                "give one column of the profile, or one value of --kpa, for each regulator; `proprio status` shows their number"
            }
            Self::OtherTable(_) => {
                "store this table on the board with `proprio table push`, or give the board's (`proprio table pull`)"
            }
            Self::Crashed(_) => {
                "turn the air off and find the cause; running `proprio drive` again acknowledges the crash"
            }
            Self::Blind => "`proprio status` shows the state of each",
            Self::HeldBack { .. } => {
                "check for lost sensors (`proprio status`); after three crashes a power cycle ends the safe mode"
            }
            Self::Restarted => "`proprio status` shows the reason of the restart",
            Self::Lost(_) => "check the cable",
            Self::Link(error) => return error.help(),
        };
        help.to_owned()
    }
}
