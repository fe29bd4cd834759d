//! The command line.

mod cli;
mod commands;
mod tables;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser;
use proprio::interrupt;
use proprio::output::discard_unfinished;

/// Exit status after Ctrl-C or a termination, as shells have it.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let command = cli::Cli::parse().command;
    // Without a handler an interrupt leaves an unfinished file behind, and nothing worse.
    let _ = ctrlc::set_handler(|| {
        if !interrupt::is_heeded() {
            discard_unfinished();
            std::process::exit(INTERRUPTED);
        }
    });
    match catch_unwind(|| command.run()) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            let (error_style, help_style) = (cli::STYLES.get_error(), cli::STYLES.get_valid());
            let remedy = error.remedy();
            commands::say(&format_args!(
                "{error_style}error:{error_style:#} {error}\n{help_style}  help:{help_style:#} {remedy}"
            ));
            ExitCode::from(2)
        }
        Err(_) => {
            commands::say(&"This is a fault of proprio. Please report it, with the message above and the command.");
            ExitCode::from(1)
        }
    }
}
