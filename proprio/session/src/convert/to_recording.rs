//! CSV or raw bytes as a recording.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use telemetry::{Decoder, Message};

use super::samples::WORK;
use super::session_recorder::{NO_ARRIVAL, SessionRecorder};
use crate::recording::Recorder;
use crate::{Error, HostNs, OutputFile, Progress, SessionError, SessionProblem, SessionReader};

/// The samples of a CSV, as a board would have sent them.
pub fn of_samples(
    mut reader: SessionReader,
    file: OutputFile,
    path: &Path,
    progress: &mut dyn Progress,
) -> Result<(OutputFile, Vec<String>), Error> {
    let failed = |source| Error::Output { path: path.to_owned(), source };
    // Both are those of the first rows, which are read ahead.
    let (has_truth, segments) = (reader.has_truth(), reader.segments());
    let mut recorder = SessionRecorder::new(file, segments, "CSV").map_err(failed)?;
    while let Some(row) = reader.next_row()? {
        progress.advance(WORK, reader.progress());
        recorder.row(&row, has_truth).map_err(failed)?;
    }
    recorder.finish().map_err(failed)
}

/// Raw bytes, frame by frame.
pub fn of_bytes(input: &Path, file: OutputFile, path: &Path) -> Result<(OutputFile, Vec<String>), Error> {
    let failed = |source| Error::Output { path: path.to_owned(), source };
    let unreadable =
        |error| SessionError { path: input.to_owned(), line: None, column: None, problem: SessionProblem::Read(error) };
    let source = BufReader::with_capacity(1 << 16, File::open(input).map_err(unreadable)?);
    let mut recorder = Recorder::new(file, HostNs(0), "raw bytes").map_err(failed)?;
    let (mut decoder, mut frame, mut at) = (Decoder::<Message>::new(), Vec::new(), HostNs(0));
    for byte in source.bytes() {
        let byte = byte.map_err(unreadable)?;
        frame.push(byte);
        if byte != 0 {
            continue;
        }
        let message = frame.iter().find_map(|byte| decoder.push(*byte)).and_then(Result::ok);
        if let Some(Message::Sample(sample)) = &message {
            at = HostNs(sample.time_us.saturating_mul(1000));
        }
        recorder.bytes(at, &frame).map_err(failed)?;
        frame.clear();
        if let Some(message) = message {
            recorder.message(at, &message).map_err(failed)?;
        }
    }
    recorder.bytes(at, &frame).map_err(failed)?;
    Ok((recorder.finish().map_err(failed)?, vec![NO_ARRIVAL.to_owned()]))
}
