//! A recording of a session's rows, as a board would have sent their samples.

use std::io::{self, Write};

use telemetry::Message;

use super::samples::SampleEncoder;
use crate::recording::Recorder;
use crate::{HostNs, Row};

/// Note about the times of a session that has none of arrival.
pub const NO_ARRIVAL: &str = "there are no times of arrival; those of the samples, from 1970 on, stand for them";

/// Writer of a session's samples, their truth and their estimates on the channels of a recording.
pub struct SessionRecorder<W: Write> {
    recorder: Recorder<W>,
    samples: SampleEncoder,
    segments: usize,
    /// Arrival and number of the last sample.
    last: (HostNs, u32),
    has_arrival: bool,
}

impl<W: Write> SessionRecorder<W> {
    /// Begins a recording of an arm of so many segments; `line` names its source.
    ///
    /// # Errors
    /// Errors of `sink`.
    pub fn new(sink: W, segments: usize, line: &str) -> io::Result<Self> {
        let at = HostNs(0);
        let recorder = Recorder::new(sink, at, line)?;
        Ok(Self { recorder, samples: SampleEncoder::new(segments), segments, last: (at, 0), has_arrival: false })
    }

    /// Attaches the table of the estimates, as TOML.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn attach_table(&mut self, toml: &[u8]) -> io::Result<()> {
        self.recorder.attach_table(HostNs(0), toml)
    }

    /// Writes a row's sample, and its truth where `has_truth`; returns the number of its tick. A row from before the begin of
    /// a recording is history.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn row(&mut self, row: &Row, has_truth: bool) -> io::Result<u32> {
        let (frame, sample) = self.samples.encode(row);
        let arrival = row.board.as_ref().map(|board| board.at).filter(|at| at.0 > 0);
        self.has_arrival |= arrival.is_some();
        let at = arrival.unwrap_or(HostNs(row.sample.time_us.saturating_mul(1000)));
        let tick = sample.tick;
        self.last = (at, tick);
        if !row.is_recorded() {
            self.recorder.history(at, &frame)?;
            return Ok(tick);
        }
        self.recorder.bytes(at, &frame)?;
        self.recorder.message(at, &Message::Sample(sample))?;
        if has_truth {
            self.recorder.truth(at, tick, &row.truth[..self.segments])?;
        }
        Ok(tick)
    }

    /// Writes an estimate, an uncertainty or a contact of the last row on its channels.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn message(&mut self, message: &Message) -> io::Result<()> {
        self.recorder.message(self.last.0, message)
    }

    /// Completes the recording; returns the sink, and notes about what it lacks.
    ///
    /// # Errors
    /// Errors of the sink.
    pub fn finish(self) -> io::Result<(W, Vec<String>)> {
        let notes = (!self.has_arrival).then(|| NO_ARRIVAL.to_owned()).into_iter().chain(self.samples.rounded());
        Ok((self.recorder.finish()?, notes.collect()))
    }
}
