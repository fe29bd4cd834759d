//! One file for each command.

mod align;
mod calibrate;
mod check;
mod completions;
mod convert;
mod drive;
mod flash;
mod link;
mod monitor;
mod ports;
mod record;
mod recover;
mod replay;
mod report;
mod simulate;
mod status;
mod tune;

use std::process::ExitCode;

use crate::args::Command;
use crate::error::Error;

impl Command {
    /// Runs the command; its exit status is 0 but for a [`check`] with findings.
    pub fn run(self) -> Result<ExitCode, Error> {
        match self {
            Self::Check(args) => return check::run(&args),
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
        }?;
        Ok(ExitCode::SUCCESS)
    }
}
