//! Conversion of sessions between file formats: CSV, a recording, or a board's raw bytes.
//!
//! Values that the new format can hold are exact to the bit; the others are reported.

mod samples;
mod session_recorder;
mod to_csv;
mod to_recording;

use std::io::Write;
use std::path::Path;

use samples::{SampleEncoder, WORK};
pub use session_recorder::SessionRecorder;
use telemetry::{Encoder, MAX_FRAME, MAX_SEGMENTS, Message};

use crate::recording::{Item, Reader};
use crate::source::SessionFile;
use crate::{
    Error, Existing, FileFormat, Header, OutputFile, Progress, RequiredColumns, SessionError, SessionProblem,
    SessionReader, WrittenFile,
};

/// A complete conversion.
#[derive(Debug)]
pub struct Converted {
    /// The output.
    pub written: WrittenFile,
    /// The values that it cannot hold.
    pub left_out: Vec<String>,
}

/// Converts `input` to `output`, in the format of its name; standard output gets CSV.
///
/// # Errors
/// [`Error::Session`] of the input, [`Error::OutputKind`] and [`Error::SameKind`], [`Error::Exists`] and [`Error::Output`].
pub fn convert(
    input: &Path,
    output: &Path,
    existing: Existing,
    progress: &mut dyn Progress,
) -> Result<Converted, Error> {
    let kind = FileFormat::of_output(output).ok_or_else(|| Error::OutputKind(output.to_owned()))?;
    let header = Header::of(input)?;
    if header.kind == kind {
        return Err(Error::SameKind(input.to_owned()));
    }
    if header.segments > MAX_SEGMENTS {
        let problem = SessionProblem::TooManySegments(header.segments);
        return Err(SessionError { path: input.to_owned(), line: None, column: None, problem }.into());
    }
    let mut file = OutputFile::create(output, &[input], existing)?;
    let reader = any_columns(input, &header)?;
    let (file, mut left_out) = match (header.kind, kind) {
        (_, FileFormat::Csv) => {
            let left_out = to_csv::write(reader, &mut file, OutputFile::error, progress)?;
            (file, left_out)
        }
        (FileFormat::Recording, _) => extract(input, file, reader.has_truth())?,
        (FileFormat::Csv, FileFormat::Raw) => frames(reader, file, progress)?,
        (FileFormat::Csv, _) => to_recording::of_samples(reader, file, output, progress)?,
        (FileFormat::Raw, _) => to_recording::of_bytes(input, file, output)?,
    };
    if !header.unknown.is_empty() {
        left_out.push(format!("the columns {} are left out", header.unknown.join(", ")));
    }
    Ok(Converted { written: file.finish()?, left_out })
}

/// The readings of a recording or of a board's bytes as the text of a CSV.
///
/// # Errors
/// [`Error::Session`] of the input.
pub fn csv_text(input: &Path, progress: &mut dyn Progress) -> Result<Vec<u8>, Error> {
    let reader = any_columns(input, &Header::of(input)?)?;
    let mut text = Vec::new();
    let failed = |_: &Vec<u8>, error| {
        let problem = SessionProblem::Read(error);
        SessionError { path: input.to_owned(), line: None, column: None, problem }.into()
    };
    to_csv::write(reader, &mut text, failed, progress)?;
    Ok(text)
}

/// A reader of whatever sensors the session has.
fn any_columns(input: &Path, header: &Header) -> Result<SessionReader, SessionError> {
    SessionReader::open(input, &RequiredColumns { bend: vec![None; header.segments], truth: false })
}

/// The bytes of a recording, one after the other.
fn extract(input: &Path, mut file: OutputFile, has_truth: bool) -> Result<(OutputFile, Vec<String>), Error> {
    let fail = |problem| SessionError { path: input.to_owned(), line: None, column: None, problem };
    let mut source = SessionFile::open(input)?;
    let summary = source.summary()?;
    let (mut encoder, mut holes) = (Encoder::new(), 0);
    for item in Reader::with_summary(source.into_bytes()?, summary) {
        let result = match item.map_err(|error| fail(SessionProblem::Recording(error)))? {
            Item::Bytes(_, bytes) | Item::History(_, bytes) => file.write_all(&bytes),
            Item::Sample(_, sample) => {
                let mut buffer = [0; MAX_FRAME];
                let frame = encoder.encode(&Message::Sample(sample), &mut buffer).expect("every sample fits a frame");
                file.write_all(frame)
            }
            Item::Hole(_) => {
                holes += 1;
                Ok(())
            }
            Item::Truth(..) | Item::Mark(..) | Item::SetPoints(_) => Ok(()),
        };
        result.map_err(|error| file.error(error))?;
    }
    let mut left_out = vec!["the times of arrival and the attachments are left out".to_owned()];
    left_out.extend((holes > 0).then(|| format!("{holes} damaged parts of the recording are left out")));
    left_out.extend(has_truth.then(|| "the truth is left out".to_owned()));
    Ok((file, left_out))
}

/// A CSV's samples as a board would send them.
fn frames(
    mut reader: SessionReader,
    mut file: OutputFile,
    progress: &mut dyn Progress,
) -> Result<(OutputFile, Vec<String>), Error> {
    let (has_truth, segments) = (reader.has_truth(), reader.segments());
    let mut samples = SampleEncoder::new(segments);
    while let Some(row) = reader.next_row()? {
        progress.advance(WORK, reader.progress());
        let (frame, _) = samples.encode(&row);
        file.write_all(&frame).map_err(|error| file.error(error))?;
    }
    let truth = has_truth.then(|| "the truth is left out".to_owned());
    Ok((file, samples.rounded().into_iter().chain(truth).collect()))
}
