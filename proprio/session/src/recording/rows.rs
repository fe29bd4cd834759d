//! From bytes to the rows of a session: what the board has read, what it made of it, and where it started anew.

use std::collections::VecDeque;

use calibration_tables::MAX_SEGMENTS;
use telemetry::{DecodeError, Decoder, Event, Hello, Message, Sample, is_same_layout};

use super::{Item, ReadError};
use crate::{BootTracker, Continuity, HostNs, Mark, OnBoard, Row, Truth};

/// Time from one tick to the next, µs.
const TICK_US: u64 = 10_000;

/// The rows of a recording.
pub(crate) struct RecordedRows<I> {
    items: I,
    decoder: Decoder<Message>,
    hello: Option<Hello>,
    runs: BootTracker,
    /// The board has restarted since the last sample.
    restarted: bool,
    /// The row that waits for its estimate, for what else the board says of its tick, and for its truth.
    open: Option<Row>,
    whole: VecDeque<Row>,
    marks: Vec<Mark>,
    last: Option<Last>,
    /// What is added to the board's time, so that it goes on over a restart, µs.
    base_us: u64,
    /// Whether every sample since the estimator's start is here.
    complete: bool,
    at_end: bool,
}

/// What the sample before was.
struct Last {
    sample: Sample,
    at: HostNs,
    row_us: u64,
    /// Frames that were lost until then.
    lost: u32,
}

impl<I: Iterator<Item = Result<Item, ReadError>>> RecordedRows<I> {
    pub fn new(items: I) -> Self {
        Self {
            items,
            decoder: Decoder::new(),
            hello: None,
            runs: BootTracker::default(),
            restarted: false,
            open: None,
            whole: VecDeque::new(),
            marks: Vec::new(),
            last: None,
            base_us: 0,
            complete: false,
            at_end: false,
        }
    }

    /// The board's last `Hello` so far.
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// The moments that were marked so far.
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// The next row, or `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Row>, ReadError> {
        loop {
            if let Some(row) = self.whole.pop_front() {
                return Ok(Some(row));
            }
            if self.at_end {
                return Ok(None);
            }
            match self.items.next().transpose()? {
                Some(Item::Bytes(at, bytes)) => {
                    for byte in bytes {
                        match self.decoder.push(byte) {
                            Some(Ok(message)) => self.take(at, message)?,
                            Some(Err(DecodeError::Version(version))) => return Err(ReadError::OtherProtocol(version)),
                            // What was damaged on the line is lost.
                            Some(Err(_)) | None => {}
                        }
                    }
                }
                Some(Item::Truth(tick, ends)) => self.truth(tick, &ends),
                Some(Item::Mark(at, text)) => self.mark(at, text),
                None => {
                    self.at_end = true;
                    self.whole.extend(self.open.take());
                }
            }
        }
    }

    fn take(&mut self, at: HostNs, message: Message) -> Result<(), ReadError> {
        match message {
            Message::Hello(hello) if !is_same_layout(hello.schema) => {
                return Err(ReadError::OtherForm(hello.firmware.as_str().to_owned()));
            }
            Message::Hello(hello) => {
                self.restarted |= self.runs.hello(hello.boot);
                self.hello = Some(hello);
            }
            Message::Sample(sample) => {
                let place = self.runs.sample(sample.tick);
                self.restarted |= place == Continuity::Restarted;
                if place != Continuity::Duplicate {
                    self.whole.extend(self.open.take());
                    self.open = Some(self.row(at, &sample));
                }
            }
            Message::Estimate(estimate) => self.told(estimate.tick, |board| board.estimate = Some(estimate)),
            Message::Uncertainty(of) => self.told(of.tick, |board| board.uncertainty = Some(of)),
            Message::Event(Event::Contact(tick, touched)) => self.told(tick, |board| board.contact = Some(touched)),
            Message::Health(_) | Message::Event(_) | Message::Reply(_) => {}
        }
        Ok(())
    }

    fn row(&mut self, at: HostNs, sample: &Sample) -> Row {
        let (lost, restarted) = (self.decoder.counts().lost, std::mem::take(&mut self.restarted));
        let mut starts = true;
        if let Some(last) = &self.last {
            let follows = sample.tick == last.sample.tick.wrapping_add(1);
            let is_whole = follows || lost == last.lost;
            if restarted || self.base_us + sample.time_us < last.row_us {
                // Its time goes on where the host's does.
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
            board: Some(OnBoard {
                tick: sample.tick,
                complete: self.complete,
                estimate: None,
                uncertainty: None,
                contact: None,
            }),
        };
        row.sample.time_us = self.base_us + sample.time_us;
        self.last = Some(Last { sample: *sample, at, row_us: row.sample.time_us, lost });
        row
    }

    /// A mark has the host's time; the sample before it tells what that is on the rows' clock.
    fn mark(&mut self, at: HostNs, text: String) {
        let time_us = self.last.as_ref().map_or(0, |last| {
            // It may have come before the sample, and was written after it.
            last.row_us.saturating_add_signed((at.0 as i64 - last.at.0 as i64) / 1000)
        });
        self.marks.push(Mark { time_us, text });
    }

    /// The row that waits, where it is of this tick.
    fn open(&mut self, tick: u32) -> Option<&mut Row> {
        self.open.as_mut().filter(|row| row.board.is_some_and(|board| board.tick == tick))
    }

    /// The board has said something of this tick.
    fn told(&mut self, tick: u32, keep: impl FnOnce(&mut OnBoard)) {
        if let Some(board) = self.open(tick).and_then(|row| row.board.as_mut()) {
            keep(board);
        }
    }

    fn truth(&mut self, tick: u32, ends: &[Option<Truth>]) {
        if let Some(row) = self.open(tick) {
            row.truth.iter_mut().zip(ends).for_each(|(truth, end)| *truth = *end);
        }
    }
}
