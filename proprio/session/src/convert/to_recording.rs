//! CSV or raw bytes as a recording.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use telemetry::{Decoder, Message};

use super::samples::Samples;
use crate::recording::Recorder;
use crate::{Error, HostNs, OutputFile, Progress, SessionError, SessionProblem, SessionReader};

const NO_ARRIVAL: &str = "there are no times of arrival; those of the samples, from 1970 on, stand for them";

/// The samples of a CSV, as a board would have sent them.
pub fn of_samples(
    reader: SessionReader,
    file: OutputFile,
    path: &Path,
    progress: &mut dyn Progress,
) -> Result<(OutputFile, Vec<String>), Error> {
    let failed = |source| Error::Output { path: path.to_owned(), source };
    let (has_truth, segments) = (reader.has_truth(), reader.segments());
    let mut samples = Samples::new(reader, progress);
    let mut recorder = Recorder::new(file, HostNs(0), "CSV").map_err(failed)?;
    while let Some((frame, sample, row)) = samples.next()? {
        let at = HostNs(sample.time_us.saturating_mul(1000));
        recorder.bytes(at, &frame).map_err(failed)?;
        let tick = sample.tick;
        recorder.message(at, &Message::Sample(sample)).map_err(failed)?;
        if has_truth {
            recorder.truth(at, tick, &row.truth[..segments]).map_err(failed)?;
        }
    }
    let file = recorder.finish().map_err(failed)?;
    Ok((file, [NO_ARRIVAL.to_owned()].into_iter().chain(samples.rounded()).collect()))
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
