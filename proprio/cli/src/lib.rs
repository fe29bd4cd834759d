//! The program `proprio`: its commands over the libraries of this workspace.
//!
//! | file or folder | purpose |
//! |---|---|
//! | `args/` | arguments |
//! | `arm/` | new arms, and arms on the board |
//! | `commands/` | one file for each command |
//! | `flash/` | flashing of the firmware |
//! | `error.rs`, `help/` | errors that stop a command, and their remedies |
//! | `live_arm.rs` | a live arm for other programs of this workspace |
//! | `terminal.rs`, `text_tables.rs`, `error_table.rs`, `status_line.rs`, `progress_bar.rs` | output for people |
//! | `interrupt.rs` | Ctrl-C |

mod args;
mod arm;
mod commands;
#[cfg(test)]
mod commands_page;
mod error;
mod error_table;
pub mod flash;
mod help;
mod interrupt;
mod live_arm;
mod progress_bar;
mod status_line;
mod terminal;
mod text_tables;

use std::ffi::OsString;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

use clap::Parser;

pub use crate::args::{LinkArgs, STYLES};
pub use crate::error::Error;
pub use crate::help::Help;
pub use crate::interrupt::ShutdownGuard;
pub use crate::live_arm::{Board, LiveArm};
pub use crate::terminal::{eprint_line, warn};

/// Runs the command of `arguments`, the first of which is the program's name. Its exit status: 0 done, 1 a finding of `check`, a loss in `recover`, or a fault of
/// proprio, 2 an input or a command that cannot be used.
#[must_use]
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let command = args::Cli::parse_from(arguments).command;
    run_command(|| command.run(), Error::is_fault)
}

/// Runs a command of a program of this workspace, prints its error with the remedy, and returns its exit status: 1 for a fault
/// of the program, 2 for another error.
#[must_use]
pub fn run_command<E: Display + Help>(
    command: impl FnOnce() -> Result<u8, E>,
    is_fault: impl FnOnce(&E) -> bool,
) -> u8 {
    interrupt::install();
    // A command that has panicked is not used again.
    match catch_unwind(AssertUnwindSafe(command)) {
        Ok(Ok(status)) => status,
        Ok(Err(error)) => {
            let (error_style, help_style) = (STYLES.get_error(), STYLES.get_valid());
            let help = error.help();
            eprint_line(&format_args!(
                "{error_style}error:{error_style:#} {error}\n{help_style}  help:{help_style:#} {help}"
            ));
            if is_fault(&error) { 1 } else { 2 }
        }
        Err(_) => {
            eprint_line(&"This is a fault of proprio. Please report it, with the message above and the command.");
            1
        }
    }
}
