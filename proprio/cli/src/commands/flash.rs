//! `proprio flash`.

use estimator_core::Q;
use proprio_link::{Baud, Kind, Link, LinkError, PortSource, find_due, list};
use proprio_session::NamedTable;
use telemetry::TICK_HZ;

use crate::args::Flash;
use crate::error::Error;
use crate::flash::{FlashError, Flashing, verify};
use crate::interrupt::{ShutdownGuard, end};
use crate::terminal;

/// What bossac writes.
const IMAGE: &str = "firmware.bin";

pub fn run(args: &Flash) -> Result<(), Error> {
    let checksum = NamedTable::load(&args.table)?.compile::<Q>(TICK_HZ)?.checksum();
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

/// Builds and writes. Ctrl-C goes to the command that runs, and ends this one after it, with nothing left behind.
fn flash(args: &Flash, port: &str) -> Result<(), FlashError> {
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

/// The native port flashes otherwise, and the firmware does not talk on it.
fn programming_port() -> Result<String, LinkError> {
    let ports: Vec<_> = list()?.into_iter().filter(|port| port.kind == Kind::DueProgramming).collect();
    Ok(find_due(&ports)?.name.clone())
}
