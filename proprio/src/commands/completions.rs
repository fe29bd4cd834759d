//! `proprio completions`.

use clap::CommandFactory;
use proprio::error::Error;

use crate::cli::{Cli, Completions};

pub fn run(args: &Completions) -> Result<(), Error> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "proprio", &mut script);
    super::print(&String::from_utf8_lossy(&script))
}
