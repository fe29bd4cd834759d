//! Status of a live arm on one line of a terminal, with warnings above it.

use std::fmt::Display;
use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use proprio_link::EventKind;

use crate::terminal;

/// The line; hidden where standard error is not a terminal.
pub struct StatusLine {
    bar: ProgressBar,
}

impl StatusLine {
    pub fn new() -> Self {
        let bar = if std::io::stderr().is_terminal() { ProgressBar::no_length() } else { ProgressBar::hidden() };
        bar.set_style(ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self { bar }
    }

    /// Shows another line.
    pub fn show(&self, line: String) {
        self.bar.set_message(line);
    }

    /// Prints the warning of an event on the link, if it has one.
    pub fn warn_of(&self, kind: &EventKind) {
        if let Some(warning) = kind.warning() {
            self.bar.suspend(|| terminal::warn(&warning));
        }
    }

    /// Ends with a line that stays.
    pub fn end(self, line: &impl Display) {
        drop(self);
        terminal::eprint_line(line);
    }
}

/// Hours, minutes and seconds.
pub fn time(passed: Duration) -> String {
    let seconds = passed.as_secs();
    format!("{}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

impl Drop for StatusLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
