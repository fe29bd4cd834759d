//! Remedies of errors of flashing.

use std::path::Path;

use proprio_link::LinkError;

use super::Help;
use crate::flash::FlashError;

impl Help for FlashError {
    fn help(&self) -> String {
        let help = match self {
            Self::Firmware { .. } => {
                "name the firmware with --firmware, or build it from the source of proprio with --from-source FOLDER"
            }
            Self::Image { .. } => {
                "give the firmware's ELF file, or its plain image (.bin), with --firmware; `cargo xtask dist` makes both"
            }
            Self::NoSource(_) => "name the folder of the source with --from-source",
            Self::Port(LinkError::NoDue) => "plug it in by its programming port, or name another port with --port",
            Self::Port(error) | Self::Unheard(error) => return error.help(),
            Self::NoFlasher(_) => INSTALL_BOSSAC,
            Self::Missing(program) | Self::Start { program, .. } => install(tool(program)),
            Self::Failed { program, .. } => check(tool(program)),
            Self::Temporary(_) => "free disk space, or set TMPDIR to a folder that can be written to",
            Self::Touch { source, .. } => return super::link::open_remedy(source).to_owned(),
            Self::Silent { .. } => "press RESET, then `proprio status`; docs/how-to/troubleshooting.md",
            Self::Other(_) => {
                "give this release's firmware with --firmware, and check that the probe and the port are of one board"
            }
            Self::Table(error) => return format!("{}; `proprio table push` stores it", error.help()),
        };
        help.to_owned()
    }
}

const INSTALL_BOSSAC: &str = "install BOSSA 1.9 (Debian, Ubuntu: apt install bossa-cli; https://github.com/shumatech/BOSSA), or \
                              the package for the Due in an Arduino IDE, or plug in a debug probe and install probe-rs \
                              (https://probe.rs)";

/// The name of a program without its folder.
fn tool(program: &str) -> &str {
    Path::new(program).file_stem().and_then(|name| name.to_str()).unwrap_or(program)
}

fn install(program: &str) -> &'static str {
    match program {
        "bossac" => INSTALL_BOSSAC,
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
