//! `proprio recover`.

use std::fs::File;
use std::path::Path;

use proprio_session::recording::{ReadError, RecoverError, Recovery, recover};
use proprio_session::{ForeignFile, OutputFile, SessionError, SessionProblem};

use crate::args::RecoverArgs;
use crate::error::Error;
use crate::terminal;

/// Recovers a recording. The exit status is 1 where a part of it is lost.
pub fn run(args: &RecoverArgs) -> Result<u8, Error> {
    let fail = |problem| SessionError { path: args.input.clone(), line: None, column: None, problem };
    let source = File::open(&args.input).map_err(|error| fail(SessionProblem::Read(error)))?;
    let mut file = OutputFile::create(&args.output, &[&args.input], args.force.existing())?;
    let recovery = recover(source, &mut file).map_err(|error| match error {
        RecoverError::Read(error) => fail(SessionProblem::Read(error)).into(),
        RecoverError::Source(ReadError::NoMcap) => fail(not_a_recording(&args.input)).into(),
        RecoverError::Source(error) => fail(SessionProblem::Recording(error)).into(),
        RecoverError::Sink(error) => file.error(error),
    })?;
    let Some((first, last)) = recovery.times_ns else { return Err(fail(SessionProblem::NothingWhole).into()) };
    let written = file.finish()?;
    warn_of_loss(args, &recovery);
    let Recovery { messages, bytes, .. } = recovery;
    let seconds = (last - first) as f64 / 1e9;
    let source = source_text(&recovery);
    let name = written.path.display();
    terminal::eprint_line(&format_args!(
        "{name}: {messages} messages of {seconds:.3} s, {source} ({bytes} bytes read)"
    ));
    Ok(u8::from(recovery.has_loss()))
}

/// The problem of a file that is no recording.
fn not_a_recording(path: &Path) -> SessionProblem {
    ForeignFile::of_file(path).map_or(SessionProblem::Recording(ReadError::NoMcap), SessionProblem::Foreign)
}

/// Names each damaged part.
fn warn_of_loss(args: &RecoverArgs, recovery: &Recovery) {
    let input = args.input.display();
    for hole in &recovery.holes {
        let times = hole.times(recovery.start_ns);
        terminal::warn(&format_args!("{input}: {times} ({} bytes from byte {})", hole.bytes, hole.offset));
    }
    if let Some(bytes) = recovery.lost_end {
        let after_s = recovery.times_ns.map_or(0.0, |(_, last)| (last - recovery.start_ns) as f64 / 1e9);
        let part = if bytes > 0 { format!(", with {bytes} bytes of a part that was cut") } else { String::new() };
        terminal::warn(&format_args!("{input}: the end is missing: all after {after_s:.2} s is lost{part}"));
    }
    if recovery.lost_attachments > 0 {
        let count = recovery.lost_attachments;
        terminal::warn(&format_args!("{input}: {count} damaged attachments or metadata are left out"));
    }
    if recovery.lost_messages > 0 {
        let count = recovery.lost_messages;
        terminal::warn(&format_args!("{input}: {count} messages are left out: their channel is damaged"));
    }
}

/// The state of the source, and the share of it that is kept.
fn source_text(recovery: &Recovery) -> String {
    if recovery.is_damaged() {
        let cut = if recovery.was_cut { ", which was cut as well" } else { "" };
        let share = match recovery.recorded {
            Some(recorded) if recorded > 0 => {
                format!("{:.2} % of its messages", 100.0 * recovery.messages as f64 / recorded as f64)
            }
            _ => format!("{:.2} % of its bytes", 100.0 * recovery.kept()),
        };
        format!("recovered from a file that is damaged{cut}: {share} are kept")
    } else if recovery.lost_end.is_some() {
        "recovered from a file that was cut".to_owned()
    } else if recovery.was_cut {
        "recovered from a file whose index was cut: no message is lost".to_owned()
    } else if recovery.index_was_damaged {
        "recovered from a file with a damaged index: no message is lost".to_owned()
    } else {
        "the file was complete".to_owned()
    }
}
