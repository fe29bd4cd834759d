//! The command line.

mod cli;
mod commands;
mod tables;

use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let command = cli::Cli::parse().command;
    proprio::interrupt::install();
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
