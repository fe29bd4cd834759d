//! `proprio flash`.

use proprio_link::table::push;
use proprio_link::{Baud, Link, LinkError, PortKind, PortSource, find_due, firmware_path, list};
use proprio_session::LoadedTable;

use super::link;
use crate::args::FlashArgs;
use crate::error::Error;
use crate::flash::{Firmware, FlashError, Step, ToolCommand, plan, verify};
use crate::interrupt::{ShutdownGuard, end};
use crate::progress_bar::Bar;
use crate::terminal;

/// File that bossac flashes.
const IMAGE: &str = "firmware.bin";

/// Stands in a dry run for a port that is not there.
const NO_PORT: &str = "PORT";

pub fn run(args: &FlashArgs) -> Result<(), Error> {
    let table = link::stored(&LoadedTable::load(&args.table)?)?;
    let firmware = firmware(args);
    if args.dry_run {
        return dry_run(args, &firmware);
    }
    let port = args.port.clone().map_or_else(programming_port, Ok).map_err(FlashError::Port)?;
    flash(&firmware, &port)?;
    terminal::eprint_line(&format_args!("waiting for the board's Hello on {port}"));
    let source = PortSource::new(Some(port.clone()), Baud::default());
    let (link, events) = Link::start(Box::new(source), None).map_err(FlashError::Unheard)?;
    verify(&link, &events)?;
    let hello = push(&link, &table, &mut Bar::new()).map_err(FlashError::Table)?;
    let (firmware, revision, arm) = (&hello.firmware, &hello.revision, &hello.arm);
    terminal::print(&format!(
        "flashed: {port} runs firmware {firmware} ({revision}) with table {:08x} of arm {arm}\n",
        hello.table
    ))
}

fn firmware(args: &FlashArgs) -> Firmware {
    match (&args.firmware, &args.from_source) {
        (Some(file), _) => Firmware::File(file.clone()),
        (None, Some(folder)) => Firmware::Source(folder.clone()),
        (None, None) => Firmware::File(firmware_path()),
    }
}

/// Prints the commands of a run. Its image would be in a temporary folder of its own.
fn dry_run(args: &FlashArgs, firmware: &Firmware) -> Result<(), Error> {
    let port = match args.port.clone().map_or_else(programming_port, Ok) {
        Err(LinkError::NoDue) => NO_PORT.to_owned(),
        port => port.map_err(FlashError::Port)?,
    };
    let mut steps = plan(firmware, &port, &std::env::temp_dir().join(IMAGE))?;
    let table = args.table.to_string_lossy();
    steps.push(Step::Run(ToolCommand::new("proprio", &["table", "push", &table, "--port", &port])));
    steps.iter().try_for_each(|step| terminal::print(&format!("{step}\n")))
}

/// Flashes. Ctrl-C goes to the running command and ends this one after it, without temporary files.
fn flash(firmware: &Firmware, port: &str) -> Result<(), FlashError> {
    let folder = tempfile::tempdir().map_err(FlashError::Temporary)?;
    let steps = plan(firmware, port, &folder.path().join(IMAGE))?;
    let shutdown = ShutdownGuard::new();
    for step in steps {
        terminal::eprint_line(&step);
        let done = step.run();
        if shutdown.is_requested() {
            drop(folder);
            end();
        }
        done?;
    }
    Ok(())
}

/// The programming port of the Due: the native port needs another procedure, and the firmware does not use it.
fn programming_port() -> Result<String, LinkError> {
    let ports: Vec<_> = list()?.into_iter().filter(|port| port.kind == PortKind::DueProgramming).collect();
    Ok(find_due(&ports)?.name.clone())
}
