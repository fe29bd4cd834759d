//! `proprio man`.

use std::fs;

use clap::CommandFactory;

use super::report::check_folder;
use crate::args::{Cli, ManArgs};
use crate::error::Error;
use crate::terminal;

pub fn run(args: &ManArgs) -> Result<(), Error> {
    let folder = &args.folder;
    check_folder(folder, args.force.existing())?;
    let written = fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(Cli::command(), folder));
    written.map_err(|source| proprio_session::Error::Output { path: folder.clone(), source })?;
    terminal::eprint_line(&format_args!("{}: manual pages written", folder.display()));
    Ok(())
}
