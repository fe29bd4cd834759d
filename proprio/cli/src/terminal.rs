//! Output of the commands: results on standard output, warnings and notices on standard error.

use std::fmt::Display;
use std::io::{self, Write};

use crate::error::Error;

/// Writes a whole text to standard output. A reader that closes it early, such as `head`, is no failure.
pub fn print(text: &str) -> Result<(), Error> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::Stdout(error)),
        _ => Ok(()),
    }
}

/// A report as JSON, on one line.
pub fn json(report: &impl serde::Serialize) -> String {
    serde_json::to_string(report).expect("numbers and names have a form in JSON") + "\n"
}

/// Writes a line to standard error, where that can be written.
pub fn eprint_line(line: &impl Display) {
    let _ = writeln!(anstream::stderr(), "{line}");
}

/// Writes a warning to standard error.
pub fn warn(warning: &impl Display) {
    let yellow = anstyle::AnsiColor::Yellow.on_default().bold();
    eprint_line(&format_args!("{yellow}warning:{yellow:#} {warning}"));
}
