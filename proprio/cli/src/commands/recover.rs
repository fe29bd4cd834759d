//! `proprio recover`.

use std::fs::File;
use std::io::BufReader;

use proprio_session::recording::{RecoverError, Recovery, recover};
use proprio_session::{OutputFile, SessionError, SessionProblem};

use crate::args::RecoverArgs;
use crate::error::Error;
use crate::terminal;

pub fn run(args: &RecoverArgs) -> Result<(), Error> {
    let fail = |problem| SessionError { path: args.input.clone(), line: None, column: None, problem };
    let source = File::open(&args.input).map_err(|error| fail(SessionProblem::Read(error)))?;
    let mut file = OutputFile::create(&args.output, &[&args.input])?;
    let recovery = recover(BufReader::with_capacity(1 << 16, source), &mut file).map_err(|error| match error {
        RecoverError::Read(error) => fail(SessionProblem::Read(error)).into(),
        RecoverError::Source(error) => fail(SessionProblem::Recording(error)).into(),
        RecoverError::Sink(error) => file.error(error),
    })?;
    let Recovery { messages, times_ns, bytes, was_cut } = recovery;
    let Some((first, last)) = times_ns else { return Err(fail(SessionProblem::NothingWhole).into()) };
    file.finish()?;
    let seconds = (last - first) as f64 / 1e9;
    let cut = if was_cut { "recovered from a file that was cut" } else { "the file was complete" };
    terminal::eprint_line(&format_args!(
        "{}: {messages} messages of {seconds:.3} s, {cut} ({bytes} bytes read)",
        args.output.display()
    ));
    Ok(())
}
