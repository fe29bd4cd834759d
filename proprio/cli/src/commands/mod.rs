//! One file for each command.

mod align;
mod calibrate;
mod check;
mod completions;
mod convert;
mod demo;
mod drive;
mod estimate_output;
mod flash;
pub(crate) mod link;
mod man;
mod monitor;
pub(crate) mod motion;
mod new_arm;
mod parallel;
mod ports;
mod record;
mod recover;
mod replay;
mod report;
mod simulate;
mod status;
mod table;
mod tare;
mod truth;
mod tune;
mod warnings;

use crate::args::Command;
use crate::error::Error;

impl Command {
    /// Runs the command. Its exit status is 0, but 1 for a [`check`] with findings and a [`recover`] with a loss.
    pub fn run(self) -> Result<u8, Error> {
        match self {
            Self::Check(args) => return check::run(&args),
            Self::Recover(args) => return recover::run(&args),
            Self::NewArm(args) => new_arm::run(&args),
            Self::Align(args) => align::run(&args),
            Self::Calibrate(args) => calibrate::run(&args),
            Self::Tune(args) => tune::run(&args),
            Self::Replay(args) => replay::run(&args),
            Self::Report(args) => report::run(&args),
            Self::Simulate(args) => simulate::run(&args),
            Self::Flash(args) => flash::run(&args),
            Self::Table(args) => table::run(&args.command),
            Self::Ports(args) => ports::run(&args),
            Self::Status(args) => status::run(&args),
            Self::Tare(args) => tare::run(&args),
            Self::Record(args) => record::run(&args),
            Self::Drive(args) => drive::run(&args),
            Self::Monitor(args) => monitor::run(&args),
            Self::Demo(args) => demo::run(&args),
            Self::Convert(args) => convert::run(&args),
            Self::Completions(args) => completions::run(&args),
            Self::Man(args) => man::run(&args),
        }?;
        Ok(0)
    }
}
