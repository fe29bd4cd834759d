//! Writes a copy of the session with columns of truth.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use csv::ByteRecord;
use proprio_session::{FileFormat, NoProgress, OutputFile, Pose, SessionError, SessionProblem, convert};

use super::alignment::Alignment;
use crate::error::Error;

/// Numbers of the written rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Written {
    /// Rows of the session.
    pub rows: usize,
    /// Rows in which the camera saw every segment.
    pub with_truth: usize,
}

impl Alignment {
    /// Writes the aligned session with its cells unchanged, a recording's as `convert` writes them, and columns of truth after
    /// them. Cells stay empty where the camera
    /// did not see the segment within 0.2 s.
    ///
    /// # Errors
    /// [`Error::File`] where the output cannot be written or the session cannot be read again.
    pub fn write(&self, session: &Path, sink: &mut OutputFile) -> Result<Written, Error> {
        let failed = |source| {
            let problem = SessionProblem::Read(source);
            SessionError { path: session.to_owned(), line: None, column: None, problem }
        };
        let text = match self.readings.kind {
            FileFormat::Csv => fs::read(session).map_err(failed)?,
            FileFormat::Recording | FileFormat::Raw => convert::csv_text(session, &mut NoProgress)?,
        };
        let starts = row_starts(&text).map_err(failed)?;
        if starts.len() != self.readings.times_us.len() + 1 {
            return Err(failed(io::Error::other("it changed meanwhile")).into());
        }
        self.write_rows(&text, &starts, sink).map_err(|error| sink.error(error).into())
    }

    fn write_rows(&self, text: &[u8], starts: &[usize], sink: &mut OutputFile) -> io::Result<Written> {
        let ends = starts.iter().skip(1).copied().chain([text.len()]);
        let mut lines = starts.iter().zip(ends).map(|(from, to)| without_line_ends(&text[*from..to]));
        sink.write_all(lines.next().unwrap_or_default())?;
        for i in 1..=self.frames.segments() {
            write!(sink, ",truth{i}_x_mm,truth{i}_y_mm,truth{i}_heading_deg")?;
        }
        writeln!(sink)?;
        let mut with_truth = 0;
        for (line, time_us) in lines.zip(&self.readings.times_us) {
            sink.write_all(line)?;
            let camera_s = self.clocks.camera_s(self.readings.since_start_s(*time_us));
            let poses: Vec<Option<Pose>> = self.frames.poses_at(camera_s).collect();
            for pose in &poses {
                write_pose(sink, pose.as_ref())?;
            }
            writeln!(sink)?;
            with_truth += usize::from(poses.iter().all(Option::is_some));
        }
        Ok(Written { rows: self.readings.times_us.len(), with_truth })
    }
}

/// Offsets of the header and each row, or of the line ends before them.
fn row_starts(text: &[u8]) -> io::Result<Vec<usize>> {
    let mut csv = csv::ReaderBuilder::new().has_headers(false).from_reader(text);
    let mut record = ByteRecord::new();
    let mut starts = Vec::new();
    while csv.read_byte_record(&mut record)? {
        starts.extend(record.position().map(|position| position.byte() as usize));
    }
    Ok(starts)
}

fn without_line_ends(mut line: &[u8]) -> &[u8] {
    while let [b'\r' | b'\n', rest @ ..] | [rest @ .., b'\r' | b'\n'] = line {
        line = rest;
    }
    line
}

fn write_pose(sink: &mut impl Write, pose: Option<&Pose>) -> io::Result<()> {
    let Some(Pose { x_m, y_m, heading_rad }) = pose else { return write!(sink, ",,,") };
    write!(sink, ",{:.4},{:.4},{:.4}", x_m * 1e3, y_m * 1e3, heading_rad.to_degrees())
}
