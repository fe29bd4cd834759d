//! Remedies of errors of flashing.

use proprio_link::LinkError;

use super::Help;
use crate::flash::FlashError;

impl Help for FlashError {
    fn help(&self) -> String {
        let help = match self {
            Self::NoSource(_) => "run it in the folder of the source, or name that with --source",
            Self::Port(LinkError::NoDue) => "plug it in by its programming port, or name another port with --port",
            Self::Port(error) | Self::Unheard(error) => return error.help(),
            Self::Missing(program) | Self::Start { program, .. } => install(program),
            Self::NoObjcopy(_) => {
                "let rustup install the pinned toolchain: `rustup toolchain install` in the source's folder"
            }
            Self::Failed { program, .. } => check(program),
            Self::Temporary(_) => "free disk space, or set TMPDIR to a folder that can be written to",
            Self::Silent { .. } => "press RESET, then `proprio status`; docs/how-to/troubleshooting.md",
            Self::OtherTable { .. } => "check that the probe and the port are of one board, and flash again",
            Self::Other(_) => {
                "give this release's source with --source, and check that the probe and the port are of one board"
            }
        };
        help.to_owned()
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

fn check(program: &str) -> &'static str {
    match program {
        "bossac" => {
            "close what has the port open; docs/how-to/troubleshooting.md explains each of its errors. The flash may be \
             erased; flash again"
        }
        "probe-rs" => "check the probe's cable and the board's supply; docs/how-to/troubleshooting.md",
        _ => "its message above has the reason; `rustup target add thumbv7m-none-eabi` if the target is missing",
    }
}
