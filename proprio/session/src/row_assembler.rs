//! Assembly of rows from the messages of a board, recorded or live.

use calibration_tables::MAX_SEGMENTS;
use telemetry::{Event, Hello, Message, Sample, TICK_US, is_same_layout};

use crate::boot_tracker::{BootTracker, Continuity};
use crate::clock::HostNs;
use crate::recording::ReadError;
use crate::row::{BoardOutput, Row, Truth};

/// Assembles the rows of a board: its readings, its estimates of them, and the starts of its estimator.
///
/// A row is complete when the next sample arrives: its estimate, uncertainty, contact and truth follow its sample.
#[derive(Debug, Default)]
pub struct RowAssembler {
    hello: Option<Hello>,
    boots: BootTracker,
    /// The board has restarted since the last sample.
    restarted: bool,
    /// The row of the last sample.
    open: Option<Row>,
    last: Option<LastSample>,
    /// Offset from the board's time to that of the rows, which continues over a restart, µs.
    base_us: u64,
    /// Every sample since the estimator's start was received.
    complete: bool,
    /// The samples are from before the begin of a recording.
    is_history: bool,
}

/// The last sample, and the state of the stream at it.
#[derive(Debug)]
struct LastSample {
    sample: Sample,
    at: HostNs,
    row_us: u64,
    /// Gaps in the stream until then.
    gaps: u32,
}

impl RowAssembler {
    /// The board's last `Hello`.
    #[must_use]
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// Takes a message that arrived at `at`; a sample completes the row before it, which is returned. `gaps` is the number of
    /// gaps in the stream until then, such as lost frames.
    ///
    /// # Errors
    /// [`ReadError::OtherForm`] of a `Hello` with another schema; further messages are ignored until one with this program's.
    pub fn message(&mut self, at: HostNs, message: &Message, gaps: u32) -> Result<Option<Row>, ReadError> {
        match message {
            Message::Hello(hello) => {
                self.restarted |= self.boots.hello(hello.boot);
                self.hello = Some(hello.clone());
                if !is_same_layout(hello.schema) {
                    return Err(ReadError::OtherForm(hello.firmware.as_str().to_owned()));
                }
            }
            _ if self.hello.as_ref().is_some_and(|hello| !is_same_layout(hello.schema)) => {}
            Message::Sample(sample) => {
                let continuity = self.boots.sample(sample.tick);
                self.restarted |= continuity == Continuity::Restarted;
                if continuity != Continuity::Duplicate {
                    let row = self.row(at, sample, gaps);
                    return Ok(self.open.replace(row));
                }
            }
            Message::Estimate(estimate) => self.output(estimate.tick, |board| board.estimate = Some(estimate.clone())),
            Message::Uncertainty(of) => self.output(of.tick, |board| board.uncertainty = Some(of.clone())),
            Message::Event(Event::Contact(tick, touched)) => self.output(*tick, |board| board.contact = Some(*touched)),
            Message::Health(health) => {
                self.output(health.tick, |board| board.set_pa = Some(health.pressures_pa.to_vec()));
            }
            Message::Event(_) | Message::Reply(_) | Message::Table(_) | Message::TableData(_) | Message::Tare(_) => {}
        }
        Ok(None)
    }

    /// Notes that the line was opened (again): the next sample is no repetition.
    pub fn line_opened(&mut self) {
        self.boots.opened();
    }

    /// Sets whether the next samples are part of a recording, or from before its begin.
    pub(crate) fn set_recorded(&mut self, is_recorded: bool) {
        self.is_history = !is_recorded;
    }

    /// Takes the row of the last sample where its estimate has arrived already, for display without delay.
    pub fn take_estimated(&mut self) -> Option<Row> {
        self.open.take_if(|row| row.board.as_ref().is_some_and(|board| board.estimate.is_some()))
    }

    /// Takes the row of the last sample, at the end of the stream.
    pub fn take_last(&mut self) -> Option<Row> {
        self.open.take()
    }

    /// Adds the true poses of the sample with this tick, if it is the last one.
    pub fn truth(&mut self, tick: u32, ends: &[Option<Truth>]) {
        if let Some(row) = self.open(tick) {
            row.truth.iter_mut().zip(ends).for_each(|(truth, end)| *truth = *end);
        }
    }

    /// Adds the pressures that the host has requested to the last sample's row.
    pub fn requested(&mut self, pressures_pa: Vec<u32>) {
        if let Some(board) = self.open.as_mut().and_then(|row| row.board.as_mut()) {
            board.requested_pa = Some(pressures_pa);
        }
    }

    /// Time of the rows at the host's time `at`, µs; 0 before the first sample.
    #[must_use]
    pub fn row_time_us(&self, at: HostNs) -> u64 {
        self.last.as_ref().map_or(0, |last| {
            // The time may be before that of the last sample.
            last.row_us.saturating_add_signed((at.0 as i64 - last.at.0 as i64) / 1000)
        })
    }

    fn row(&mut self, at: HostNs, sample: &Sample, gaps: u32) -> Row {
        let restarted = std::mem::take(&mut self.restarted);
        let mut starts = true;
        if let Some(last) = &self.last {
            let follows = sample.tick == last.sample.tick.wrapping_add(1);
            let is_whole = follows || gaps == last.gaps;
            if restarted || self.base_us + sample.time_us < last.row_us {
                // The time of the rows continues by the host's clock.
                let passed_us = (at.0.saturating_sub(last.at.0) / 1000).max(TICK_US);
                self.base_us = (last.row_us + passed_us).saturating_sub(sample.time_us);
                self.complete = sample.tick == 0;
            } else if sample.tare_epoch != last.sample.tare_epoch {
                self.complete = is_whole;
            } else {
                starts = false;
                self.complete &= is_whole;
            }
        } else {
            self.complete = sample.tick == 0;
        }
        let mut row = Row {
            sample: sample.into(),
            truth: [None; MAX_SEGMENTS],
            starts,
            board: Some(BoardOutput {
                tick: sample.tick,
                time_us: sample.time_us,
                segments: sample.imu.len(),
                at,
                complete: self.complete,
                recorded: !self.is_history,
                estimate: None,
                uncertainty: None,
                contact: None,
                set_pa: None,
                requested_pa: None,
            }),
        };
        row.sample.time_us = self.base_us + sample.time_us;
        self.last = Some(LastSample { sample: sample.clone(), at, row_us: row.sample.time_us, gaps });
        row
    }

    /// The row of the last sample, if it is of this tick.
    fn open(&mut self, tick: u32) -> Option<&mut Row> {
        self.open.as_mut().filter(|row| row.board.as_ref().is_some_and(|board| board.tick == tick))
    }

    /// Adds a message of the board to the row of this tick.
    fn output(&mut self, tick: u32, set: impl FnOnce(&mut BoardOutput)) {
        if let Some(board) = self.open(tick).and_then(|row| row.board.as_mut()) {
            set(board);
        }
    }
}
