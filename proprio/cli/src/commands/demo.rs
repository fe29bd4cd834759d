//! `proprio demo`: the monitor of an emulated board, which needs no other file.

use std::path::PathBuf;

use proprio_link::Baud;

use super::monitor;
use crate::args::{DemoArgs, FoxgloveArgs, LinkArgs, MonitorArgs};
use crate::error::Error;
use crate::terminal;

pub fn run(args: &DemoArgs) -> Result<(), Error> {
    terminal::eprint_line(
        &"An emulated Arduino Due runs the firmware, with a simulated arm on its pins. Open this address in a browser; Ctrl-C ends.",
    );
    monitor::run(&MonitorArgs {
        session: None,
        link: LinkArgs {
            port: None,
            baud: Baud::default(),
            emulated: true,
            firmware: None,
            flash: None,
            scenario: 1,
            seed: 1,
            arm: None,
            table: None,
        },
        listen: args.listen,
        foxglove: FoxgloveArgs { foxglove: None },
        folder: PathBuf::from("."),
        allow_control: false,
        plain: false,
    })
}
