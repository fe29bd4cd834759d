//! `proprio table`.

use std::io::Write;
use std::path::Path;

use proprio_link::table::{TableOnBoard, erase, on_board, pull, push};
use proprio_session::{Existing, LoadedTable, OutputFile};
use telemetry::TableStatus;

use super::link;
use crate::args::{LinkArgs, TableCommand};
use crate::arm::REFERENCE_WIRING;
use crate::error::Error;
use crate::progress_bar::Bar;
use crate::{terminal, text_tables};

pub fn run(command: &TableCommand) -> Result<(), Error> {
    match command {
        TableCommand::Push { file, link } => push_file(file, link),
        TableCommand::Pull { output, force, link } => pull_into(output, force.existing(), link),
        TableCommand::Show { link } => show(link),
        TableCommand::Erase { link } => erase_table(link),
    }
}

fn push_file(file: &Path, args: &LinkArgs) -> Result<(), Error> {
    let table = LoadedTable::load(file)?;
    let stored = link::stored(&table)?;
    let (arm, checksum) = if let Some(monitor) = link::monitor(args) {
        let pushed = monitor.push_table(&String::from_utf8_lossy(&table.toml()?))?;
        (pushed.arm, pushed.checksum)
    } else {
        let (_, link, _) = link::open(args)?;
        let hello = push(&link, &stored, &mut Bar::new())?;
        (hello.arm.as_str().to_owned(), hello.table)
    };
    let bytes = stored.image.len() + stored.source.len();
    let file = file.display();
    terminal::print(&format!("{file}: on the board and in use, table {checksum:08x} of arm {arm}, {bytes} bytes\n"))?;
    if table.file.board.is_none() {
        terminal::print(&format!("{REFERENCE_WIRING}\n"))?;
    }
    if table.file.is_description() {
        terminal::print("it is an arm description: the board sends samples, and no shape until it has a table\n")?;
    }
    Ok(())
}

fn pull_into(output: &Path, existing: Existing, args: &LinkArgs) -> Result<(), Error> {
    let mut file = OutputFile::create(output, &[], existing)?;
    let toml = if let Some(monitor) = link::monitor(args) {
        monitor.pull_table()?
    } else {
        let (_, link, _) = link::open(args)?;
        pull(&link, &mut Bar::new())?.toml
    };
    file.write_all(toml.as_bytes()).map_err(|error| file.error(error))?;
    terminal::eprint_line(&file.finish()?);
    Ok(())
}

fn erase_table(args: &LinkArgs) -> Result<(), Error> {
    if let Some(monitor) = link::monitor(args) {
        monitor.erase_table()?;
    } else {
        let (_, link, _) = link::open(args)?;
        erase(&link)?;
    }
    terminal::print("the board has no table and sends samples alone\n")
}

fn show(args: &LinkArgs) -> Result<(), Error> {
    let TableOnBoard { arm, checksum, state } = if let Some(monitor) = link::monitor(args) {
        monitor.table()?
    } else {
        let (_, link, _) = link::open(args)?;
        on_board(&link)?
    };
    let status = match state.status {
        TableStatus::InUse => "in use",
        TableStatus::Missing => "missing: the board sends samples alone; store one with `proprio table push`",
        TableStatus::Damaged => "damaged: the board sends samples alone; store it again with `proprio table push`",
        TableStatus::Foreign => "of another version of the firmware; store it again with `proprio table push`",
        TableStatus::Unusable => "for a larger arm than the firmware has room for",
    };
    let lines = [
        ("state", status.to_owned()),
        ("arm", arm),
        ("checksum", format!("{checksum:08x}")),
        ("number", state.generation.to_string()),
        ("size", format!("{} bytes, and {} bytes of source", state.image_bytes, state.source_bytes)),
    ];
    terminal::print(&text_tables::pairs(&lines))
}
