//! The stream of a board for the subscribers of a link: its bytes, what is decoded from them, and the state that they show.

use std::sync::Arc;

use proprio_session::HostNs;
use telemetry::Counts;

use crate::event::{EventKind, LinkEvent};
use crate::history::ReceivedBytes;
use crate::shared::SharedLink;
use crate::stream_decoder::{Received, StreamDecoder};

/// Decodes the stream and publishes its events.
pub(super) struct StreamPublisher {
    shared: Arc<SharedLink>,
    decoder: StreamDecoder,
    /// Counts of the bytes before the link's first event.
    before: Counts,
}

impl StreamPublisher {
    /// Compares the board's table with the checksum `table`, where there is one.
    pub fn new(shared: Arc<SharedLink>, table: Option<u32>) -> Self {
        Self { shared, decoder: StreamDecoder::new(table), before: Counts::default() }
    }

    /// Version of the protocol that the board uses, once it is known.
    pub fn version(&self) -> Option<u8> {
        self.decoder.version()
    }

    /// The line of this name was opened.
    pub fn opened(&mut self, at: HostNs, name: &str) {
        self.decoder.open();
        self.shared.state().port = Some(name.to_owned());
        self.publish(at, EventKind::Opened(name.to_owned()));
    }

    /// Joins a line that was opened before, and decodes the bytes that were received until now; of all that, the mismatches alone
    /// are published.
    pub fn join(&mut self, at: HostNs, name: &str, history: &[ReceivedBytes]) {
        self.decoder.open();
        self.shared.state().port = Some(name.to_owned());
        for byte in history.iter().flat_map(|(_, bytes)| bytes.iter()) {
            self.decoder.push(*byte, drop);
        }
        self.before = self.decoder.counts();
        self.update_state();
        for mismatch in self.decoder.mismatches() {
            self.publish(at, EventKind::Mismatch(mismatch.clone()));
        }
    }

    /// Decodes received bytes and publishes their events; each part of the stream is passed to `take` first.
    pub fn bytes(&mut self, at: HostNs, bytes: &Arc<[u8]>, mut take: impl FnMut(&Received)) {
        self.publish(at, EventKind::Bytes(Arc::clone(bytes)));
        let mut received = Vec::new();
        for byte in bytes.iter() {
            self.decoder.push(*byte, |part| received.push(part));
            for part in received.drain(..) {
                take(&part);
                self.publish(at, event_kind(part));
            }
        }
        self.shared.state().bytes += bytes.len() as u64;
        self.update_state();
    }

    fn update_state(&self) {
        let Self { shared, decoder, before } = self;
        let mut state = shared.state();
        state.counts = since(*before, decoder.counts());
        state.restarts = decoder.restarts();
        if state.hello.as_ref() != decoder.hello() {
            state.hello = decoder.hello().cloned();
        }
        if state.mismatches.len() != decoder.mismatches().len() {
            state.mismatches = decoder.mismatches().to_vec();
        }
    }

    /// Publishes an event.
    pub fn publish(&self, at: HostNs, kind: EventKind) {
        self.shared.publish(&LinkEvent { at, gaps: self.decoder.gaps(), kind });
    }
}

/// The counts since `before`.
fn since(before: Counts, now: Counts) -> Counts {
    Counts {
        received: now.received.saturating_sub(before.received),
        damaged: now.damaged.saturating_sub(before.damaged),
        lost: now.lost.saturating_sub(before.lost),
        wrong_version: now.wrong_version.saturating_sub(before.wrong_version),
        unknown: now.unknown.saturating_sub(before.unknown),
    }
}

fn event_kind(received: Received) -> EventKind {
    match received {
        Received::Message(message) => EventKind::Message(message),
        Received::Undecoded(error) => EventKind::Undecoded(error),
        Received::Restarted => EventKind::Restarted,
        Received::Mismatch(mismatch) => EventKind::Mismatch(mismatch),
    }
}
