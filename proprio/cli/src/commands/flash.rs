//! `proprio flash`.

use estimator_core::Q;
use proprio_link::{Baud, Link, LinkError, PortKind, PortSource, find_due, list};
use proprio_session::LoadedTable;
use telemetry::TICK_HZ;

use crate::args::FlashArgs;
use crate::error::Error;
use crate::flash::{FlashError, Flashing, verify};
use crate::interrupt::{ShutdownGuard, end};
use crate::terminal;

/// File that bossac flashes.
const IMAGE: &str = "firmware.bin";

pub fn run(args: &FlashArgs) -> Result<(), Error> {
    let checksum = LoadedTable::load(&args.table)?.compile::<Q>(TICK_HZ)?.checksum();
    let port = args.port.clone().map_or_else(programming_port, Ok).map_err(FlashError::Port)?;
    if args.dry_run {
        let image = std::env::temp_dir().join(IMAGE);
        return terminal::print(&Flashing::plan(&args.source, &args.table, &port, &image)?.to_string());
    }
    flash(args, &port)?;
    terminal::eprint_line(&format_args!("waiting for the board's Hello on {port}"));
    let (link, events) = Link::start(Box::new(PortSource::new(Some(port.clone()), Baud::default())), Some(checksum))
        .map_err(FlashError::Unheard)?;
    let hello = verify(&link, &events)?;
    let (firmware, revision, arm) = (&hello.firmware, &hello.revision, &hello.arm);
    terminal::print(&format!(
        "flashed: {port} runs firmware {firmware} ({revision}) with table {checksum:08x} of arm {arm}\n"
    ))
}

/// Builds and flashes. Ctrl-C goes to the running command and ends this one after it, without temporary files.
fn flash(args: &FlashArgs, port: &str) -> Result<(), FlashError> {
    let folder = tempfile::tempdir().map_err(FlashError::Temporary)?;
    let flashing = Flashing::plan(&args.source, &args.table, port, &folder.path().join(IMAGE))?;
    flashing.check()?;
    let shutdown = ShutdownGuard::new();
    for step in flashing.steps() {
        terminal::eprint_line(step);
        let done = flashing.run(step);
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
