//! Output of the commands: results on standard output, warnings and notices on standard error.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;

use proprio_session::is_stdout;

use crate::error::Error;

/// Writes a whole text to standard output. A reader that closes it early, such as `head`, is no failure.
pub fn print(text: &str) -> Result<(), Error> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::Stdout(error)),
        _ => Ok(()),
    }
}

/// Writes a whole text to standard output, or to standard error where `output`, a file of this command, is standard output.
pub fn print_beside(output: Option<&Path>, text: &str) -> Result<(), Error> {
    if output.is_some_and(is_stdout) {
        // As for every line on standard error, a failure is no error of the command.
        let _ = anstream::stderr().write_all(text.as_bytes());
        return Ok(());
    }
    print(text)
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
