//! The rows of a recording, with its marks.

use std::collections::VecDeque;

use telemetry::{DecodeError, Decoder, Hello, Message};

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

    /// The next row, or `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Row>, ReadError> {
        loop {
            if let Some(row) = self.complete.pop_front() {
                return Ok(Some(row));
            }
            if self.at_end {
                return Ok(None);
            }
            match self.items.next().transpose()? {
                Some(Item::Bytes(at, bytes)) => {
                    for byte in bytes {
                        self.push(at, byte)?;
                    }
                }
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

    fn push(&mut self, at: HostNs, byte: u8) -> Result<(), ReadError> {
        match self.decoder.push(byte) {
            Some(Ok(message)) => {
                let row = self.assembler.message(at, &message, self.decoder.counts().lost)?;
                self.complete.extend(row);
                Ok(())
            }
            Some(Err(DecodeError::Version(version))) => Err(ReadError::OtherProtocol(version)),
            // A damaged frame counts as lost.
            Some(Err(_)) | None => Ok(()),
        }
    }
}
