//! `proprio tare`.

use proprio_link::tare;
use telemetry::TareMode;

use super::link;
use crate::args::TareArgs;
use crate::error::Error;
use crate::terminal;

pub fn run(args: &TareArgs) -> Result<(), Error> {
    let (_, link, _) = link::open(&args.link)?;
    let tared = tare(&link, if args.force { TareMode::Force } else { TareMode::IfStill })?;
    terminal::print(&format!("{tared}\n"))
}
