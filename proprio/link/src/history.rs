//! The bytes since the last start of the board's estimator, which a recording that begins later needs for its state.

use std::collections::VecDeque;
use std::sync::Arc;

use proprio_session::{HostNs, RowAssembler};
use telemetry::{Decoder, Message};

use crate::event::{EventKind, LinkEvent};

/// Most bytes that are held: 3 h 30 min of the full stream.
const MOST: usize = 256_000_000;

/// Bytes that are held in front of those of a start: the frames of the tick before, by which it is a start.
const KEPT: usize = 4096;

/// Bytes that were received at a time.
pub type ReceivedBytes = (HostNs, Arc<[u8]>);

/// Decodes the bytes of a history, and passes the event of each message to `take`.
pub fn decoded(history: &[ReceivedBytes], mut take: impl FnMut(&LinkEvent)) {
    let mut decoder = Decoder::<Message>::new();
    for (at, bytes) in history {
        for byte in bytes.iter() {
            let Some(Ok(message)) = decoder.push(*byte) else { continue };
            let gaps = decoder.counts().lost;
            take(&LinkEvent { at: *at, gaps, kind: EventKind::Message(message) });
        }
    }
}

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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use telemetry::{Encoder, MAX_FRAME, Sample};

    use super::{EventKind, History, HostNs, KEPT, LinkEvent, Message};

    /// A board that sends samples, and a history of its stream.
    struct Stream {
        encoder: Encoder,
        history: History,
        gaps: u32,
        tick: u32,
    }

    impl Stream {
        fn new(most: usize) -> Self {
            Self { encoder: Encoder::new(), history: History::with_most(most), gaps: 0, tick: 0 }
        }

        /// Sends samples, each with its bytes in front.
        fn run(&mut self, ticks: u32, tare_epoch: u8) {
            for _ in 0..ticks {
                let (tick, time_us) = (self.tick, u64::from(self.tick) * 10_000);
                let sample = Message::Sample(Sample {
                    tick,
                    time_us,
                    tare_epoch,
                    bend: [None; 12].into_iter().collect(),
                    imu: [None; 6].into_iter().collect(),
                });
                let mut buffer = [0; MAX_FRAME];
                let frame = self.encoder.encode(&sample, &mut buffer).expect("it fits");
                for kind in [EventKind::Bytes(Arc::from(frame)), EventKind::Message(sample.clone())] {
                    self.history.take(&LinkEvent { at: HostNs(time_us * 1000), gaps: self.gaps, kind });
                }
                self.tick += 1;
            }
        }

        /// Bytes that are held, where they are whole.
        fn held(&self) -> Option<usize> {
            let whole = self.history.whole()?;
            Some(whole.iter().map(|(_, bytes)| bytes.len()).sum())
        }
    }

    /// Length of the frame of a sample.
    const FRAME: usize = 97;

    #[test]
    fn a_history_begins_with_the_boot_and_anew_with_each_tare() {
        let mut stream = Stream::new(1_000_000);
        stream.run(1000, 0);
        assert_eq!(stream.held(), Some(1000 * FRAME));
        stream.run(1, 1);
        let held = stream.held().expect("it is whole");
        assert!((KEPT + FRAME..KEPT + 2 * FRAME).contains(&held), "{held}");
        stream.run(500, 1);
        assert_eq!(stream.held(), Some(held + 500 * FRAME));
    }

    #[test]
    fn a_history_without_a_lost_sample_is_none_until_the_next_tare() {
        let mut stream = Stream::new(1_000_000);
        stream.run(100, 1);
        stream.tick += 1;
        stream.gaps += 1;
        stream.run(100, 1);
        assert_eq!(stream.held(), None);
        stream.run(100, 2);
        assert!(stream.held().is_some());
    }

    #[test]
    fn a_history_over_its_bound_is_dropped_until_the_next_tare() {
        let mut stream = Stream::new(500 * FRAME);
        stream.run(500, 0);
        assert_eq!(stream.held(), Some(500 * FRAME));
        stream.run(1, 0);
        assert_eq!(stream.held(), None);
        stream.run(10_000, 0);
        assert!(stream.history.bytes < KEPT + 2 * FRAME, "{} bytes in memory", stream.history.bytes);
        stream.run(100, 1);
        assert!(stream.held().is_some());
    }

    /// As on a line that was opened late.
    #[test]
    fn a_stream_that_does_not_begin_with_the_boot_has_no_history_before_a_tare() {
        let mut stream = Stream::new(1_000_000);
        stream.tick = 700;
        stream.run(300, 1);
        assert_eq!(stream.held(), None);
        stream.run(1, 2);
        assert!(stream.held().is_some());
    }
}
