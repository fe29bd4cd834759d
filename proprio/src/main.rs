//! The command line.

mod cli;
mod commands;
mod tables;

use std::process::ExitCode;

use clap::Parser;
use proprio::error::Error;

fn main() -> ExitCode {
    match cli::Cli::parse().command.run() {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that has seen enough, such as `head`, is no failure.
        Err(Error::Stdout(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            let bold = cli::STYLES.get_error();
            anstream::eprintln!("{bold}error:{bold:#} {error}\n{bold:#}  help: {}", error.remedy());
            ExitCode::from(2)
        }
    }
}
