//! The bytes since the last start of the board's estimator, which a recording that begins later needs for its state.

use std::collections::VecDeque;
use std::sync::Arc;

use proprio_session::{HostNs, RowAssembler};

use crate::event::{EventKind, LinkEvent};

/// Most bytes that are held: 3 h 30 min of the full stream.
const MOST: usize = 256_000_000;

/// Bytes that are held in front of those of a start: the frames of the tick before, by which it is a start.
const KEPT: usize = 4096;

/// Bytes that were received at a time.
pub type ReceivedBytes = (HostNs, Arc<[u8]>);

/// The bytes from the last start of the board's estimator on: its boot or a tare.
///
/// It is empty where a sample since then was not received, and from the bound on until the next start.
#[derive(Debug)]
pub struct History {
    most: usize,
    assembler: RowAssembler,
    received: VecDeque<ReceivedBytes>,
    bytes: usize,
    is_whole: bool,
}

impl History {
    /// Before the line's first byte.
    pub fn new() -> Self {
        Self::with_most(MOST)
    }

    fn with_most(most: usize) -> Self {
        Self { most, assembler: RowAssembler::default(), received: VecDeque::new(), bytes: 0, is_whole: false }
    }

    /// Takes the next event.
    pub fn take(&mut self, event: &LinkEvent) {
        match &event.kind {
            EventKind::Opened(_) => self.assembler.line_opened(),
            EventKind::Bytes(bytes) => {
                self.bytes += bytes.len();
                self.received.push_back((event.at, Arc::clone(bytes)));
                if !self.is_whole {
                    self.forget();
                } else if self.bytes > self.most {
                    self.is_whole = false;
                    self.forget();
                }
            }
            EventKind::Message(message) => {
                // A `Hello` with another schema has an event of its own.
                let _ = self.assembler.message(event.at, message, event.gaps);
                let Some(row) = self.assembler.take_last() else { return };
                if row.starts {
                    self.forget();
                    self.is_whole = true;
                }
                self.is_whole &= row.is_comparable();
            }
            _ => {}
        }
    }

    /// Drops all but the last bytes, in which a frame may end, and [`KEPT`] bytes in front of them.
    fn forget(&mut self) {
        let last = self.received.back().map_or(0, |(_, bytes)| bytes.len());
        while let Some((_, first)) = self.received.front()
            && self.bytes - last >= KEPT + first.len()
        {
            self.bytes -= first.len();
            self.received.pop_front();
        }
    }

    /// The bytes since the last start; `None` where they are not all here.
    pub fn whole(&self) -> Option<Vec<ReceivedBytes>> {
        self.is_whole.then(|| self.received.iter().cloned().collect())
    }
}
