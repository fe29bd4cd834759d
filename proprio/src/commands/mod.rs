//! One file a command.

mod align;
mod calibrate;
mod completions;
mod convert;
mod drive;
mod flash;
mod link;
mod monitor;
mod ports;
mod record;
mod recorder;
mod recover;
mod replay;
mod report;
mod screen;
mod simulate;
mod status;
mod tune;

use std::io::{self, Write};

use proprio::error::Error;

use crate::cli::Command;

impl Command {
    pub fn run(self) -> Result<(), Error> {
        match self {
            Self::Align(args) => align::run(&args),
            Self::Calibrate(args) => calibrate::run(&args),
            Self::Tune(args) => tune::run(&args),
            Self::Replay(args) => replay::run(&args),
            Self::Report(args) => report::run(&args),
            Self::Simulate(args) => simulate::run(&args),
            Self::Flash(args) => flash::run(&args),
            Self::Ports(args) => ports::run(&args),
            Self::Status(args) => status::run(&args),
            Self::Record(args) => record::run(&args),
            Self::Drive(args) => drive::run(&args),
            Self::Monitor(args) => monitor::run(&args),
            Self::Convert(args) => convert::run(&args),
            Self::Recover(args) => recover::run(&args),
            Self::Completions(args) => completions::run(&args),
        }
    }
}

/// Writes a whole text to standard output. A reader that has seen enough, such as `head`, is no failure.
fn print(text: &str) -> Result<(), Error> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::Stdout(error)),
        _ => Ok(()),
    }
}

/// A report as JSON, on one line.
fn json(report: &impl serde::Serialize) -> String {
    serde_json::to_string(report).expect("numbers and names have a form in JSON") + "\n"
}

/// Writes a line to standard error, if that can be written at all.
pub fn say(line: &impl std::fmt::Display) {
    let _ = writeln!(anstream::stderr(), "{line}");
}

fn warn(warning: &impl std::fmt::Display) {
    let yellow = anstyle::AnsiColor::Yellow.on_default().bold();
    say(&format_args!("{yellow}warning:{yellow:#} {warning}"));
}
