//! Replacement of files.

use clap::Args;
use proprio_session::Existing;

#[derive(Debug, Args)]
pub struct ForceArgs {
    /// Replace files that are there already; without it they stay, and the command is refused
    #[arg(long)]
    force: bool,
}

impl ForceArgs {
    /// Treatment of files that are there already.
    pub fn existing(&self) -> Existing {
        if self.force { Existing::Replace } else { Existing::Keep }
    }
}
