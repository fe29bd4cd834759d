//! The rows of a recording, with its marks.

use std::collections::VecDeque;

use telemetry::{DecodeError, Decoder, Hello, Message};

use super::hole::HoleTimes;
use super::read_error::ReadError;
use super::reader::Item;
use crate::clock::HostNs;
use crate::row::{Mark, Row};
use crate::row_assembler::RowAssembler;

/// The rows of a recording.
pub(crate) struct RecordedRows<I> {
    items: I,
    decoder: Decoder<Message>,
    assembler: RowAssembler,
    complete: VecDeque<Row>,
    marks: Vec<Mark>,
    holes: Vec<HoleTimes>,
    /// Number of holes.
    gaps: u32,
    /// Time of the last row that was returned, s.
    last_s: Option<f64>,
    at_end: bool,
}

impl<I: Iterator<Item = Result<Item, ReadError>>> RecordedRows<I> {
    pub fn new(items: I) -> Self {
        Self {
            items,
            decoder: Decoder::new(),
            assembler: RowAssembler::default(),
            complete: VecDeque::new(),
            marks: Vec::new(),
            holes: Vec::new(),
            gaps: 0,
            last_s: None,
            at_end: false,
        }
    }

    /// The board's last `Hello` so far.
    pub fn hello(&self) -> Option<&Hello> {
        self.assembler.hello()
    }

    /// The marks that were read so far.
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// The holes of a damaged recording that were read so far, by the times of the rows.
    pub fn holes(&self) -> &[HoleTimes] {
        &self.holes
    }

    /// The next row, or `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Row>, ReadError> {
        loop {
            if let Some(row) = self.complete.pop_front() {
                let time_s = row.sample.time_us as f64 / 1e6;
                if let Some(hole) =
                    self.holes.last_mut().filter(|hole| hole.from_s.is_none_or(|from_s| from_s < time_s))
                {
                    hole.to_s.get_or_insert(time_s);
                }
                self.last_s = Some(time_s);
                return Ok(Some(row));
            }
            if self.at_end {
                return Ok(None);
            }
            match self.items.next().transpose()? {
                Some(Item::Bytes(at, bytes)) => self.push(at, &bytes, true)?,
                Some(Item::History(at, bytes)) => self.push(at, &bytes, false)?,
                Some(Item::Sample(at, sample)) => {
                    self.assembler.set_recorded(true);
                    let row = self.assembler.message(at, &Message::Sample(sample), self.gaps)?;
                    self.complete.extend(row);
                }
                Some(Item::Hole(_)) => self.hole(),
                Some(Item::SetPoints(pressures_pa)) => self.assembler.requested(pressures_pa),
                Some(Item::Truth(tick, ends)) => self.assembler.truth(tick, &ends),
                Some(Item::Mark(at, text)) => {
                    self.marks.push(Mark { time_us: self.assembler.row_time_us(at), text });
                }
                None => {
                    self.at_end = true;
                    self.complete.extend(self.assembler.take_last());
                }
            }
        }
    }

    /// Notes a hole behind the last row. An estimator of the board has had samples in it that a replay does not have.
    fn hole(&mut self) {
        self.complete.extend(self.assembler.take_last());
        self.gaps += 1;
        let from_s = self.complete.back().map(|row| row.sample.time_us as f64 / 1e6).or(self.last_s);
        if self.holes.last().is_none_or(|hole| hole.from_s != from_s) {
            self.holes.push(HoleTimes { from_s, to_s: None });
        }
    }

    /// Decodes received bytes: those of the history are the begin of one stream with those of the recording.
    fn push(&mut self, at: HostNs, bytes: &[u8], is_recorded: bool) -> Result<(), ReadError> {
        self.assembler.set_recorded(is_recorded);
        for byte in bytes {
            match self.decoder.push(*byte) {
                Some(Ok(message)) => {
                    let gaps = self.decoder.counts().lost.saturating_add(self.gaps);
                    self.complete.extend(self.assembler.message(at, &message, gaps)?);
                }
                Some(Err(DecodeError::Version(version))) => return Err(ReadError::OtherProtocol(version)),
                // A damaged frame counts as lost.
                Some(Err(_)) | None => {}
            }
        }
        Ok(())
    }
}
