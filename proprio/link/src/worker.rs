//! The link's thread.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use proprio_session::{HostClock, HostNs};
use telemetry::{Command, Message, SetPressures};

use crate::event::{EventKind, LinkEvent};
use crate::requests::Requests;
use crate::shared::{LinkRequest, SharedLink};
use crate::source::{OpenedLine, Source, Transport};
use crate::stream_decoder::{Received, StreamDecoder};

/// Time between two attempts to open a line that is gone.
const RETRY_PERIOD: Duration = Duration::from_millis(300);

/// State of the thread.
pub(super) struct Worker {
    source: Box<dyn Source>,
    received: Receiver<LinkRequest>,
    shared: Arc<SharedLink>,
    clock: HostClock,
    decoder: StreamDecoder,
    requests: Requests,
}

/// The link was dropped.
struct LinkDropped;

impl Worker {
    pub fn new(
        source: Box<dyn Source>,
        table: Option<u32>,
        received: Receiver<LinkRequest>,
        shared: Arc<SharedLink>,
    ) -> Self {
        let (clock, decoder, requests) = (HostClock::new(), StreamDecoder::new(table), Requests::default());
        Self { source, received, shared, clock, decoder, requests }
    }

    /// Works until the link is dropped or its line is gone for good; waits for a line that is not there yet.
    pub fn run(mut self, mut opened: Option<OpenedLine>) {
        loop {
            let line = opened.take().map_or_else(|| self.open_again(), Ok);
            let Ok((name, mut transport)) = line else { return };
            let Ok(reason) = self.work(&name, transport.as_mut()) else { return };
            drop(transport);
            self.requests.interrupt();
            if !self.source.can_reconnect() {
                return self.publish(EventKind::Ended(reason));
            }
            self.publish(EventKind::Lost(reason));
        }
    }

    /// Works on an open line until it is lost; returns the reason.
    fn work(&mut self, name: &str, transport: &mut dyn Transport) -> Result<String, LinkDropped> {
        self.decoder.open();
        self.shared.state().port = Some(name.to_owned());
        self.publish(EventKind::Opened(name.to_owned()));
        let mut buffer = [0; 4096];
        loop {
            self.take_requests()?;
            let due = self.requests.due(Instant::now());
            let sent = due.map_or(Ok(()), |bytes| transport.write(&bytes));
            match sent.and_then(|()| transport.read(&mut buffer)) {
                Ok(0) => {}
                Ok(count) => self.decode(&buffer[..count]),
                Err(error) => {
                    self.shared.state().port = None;
                    return Ok(format!("{name}: {error}"));
                }
            }
        }
    }

    fn open_again(&mut self) -> Result<OpenedLine, LinkDropped> {
        loop {
            std::thread::sleep(RETRY_PERIOD);
            self.take_requests()?;
            // Without a line there is no answer.
            self.requests.interrupt();
            let opened = self.source.open();
            let mut state = self.shared.state();
            match opened {
                Ok(opened) => {
                    // The first opening of a line that was waited for is no other one.
                    state.reopened += u32::from(state.waiting.take().is_none());
                    return Ok(opened);
                }
                Err(error) if state.waiting.is_some() => state.waiting = Some(error.to_string()),
                Err(_) => {}
            }
        }
    }

    fn take_requests(&mut self) -> Result<(), LinkDropped> {
        loop {
            match self.received.try_recv() {
                Ok(LinkRequest::Command(command, answer)) => {
                    if let Some(requested) = set_points(&command) {
                        self.publish(EventKind::SetPoints(requested));
                    }
                    self.requests.push(*command, answer);
                }
                Ok(LinkRequest::Stop) | Err(TryRecvError::Disconnected) => return Err(LinkDropped),
                Err(TryRecvError::Empty) => return Ok(()),
            }
        }
    }

    fn decode(&mut self, bytes: &[u8]) {
        let at = self.clock.now();
        self.publish_at(at, EventKind::Bytes(bytes.into()));
        let mut received = Vec::new();
        for byte in bytes {
            self.decoder.push(*byte, |part| received.push(part));
            for part in received.drain(..) {
                let kind = event_kind(part, &mut self.requests);
                self.publish_at(at, kind);
            }
        }
        let Self { decoder, requests, shared, .. } = self;
        requests.set_version(decoder.version());
        let mut state = shared.state();
        state.bytes += bytes.len() as u64;
        state.counts = decoder.counts();
        state.is_connected = requests.is_connected();
        state.restarts = decoder.restarts();
        if state.hello.as_ref() != decoder.hello() {
            state.hello = decoder.hello().cloned();
        }
        if state.mismatches.len() != decoder.mismatches().len() {
            state.mismatches = decoder.mismatches().to_vec();
        }
    }

    fn publish(&self, kind: EventKind) {
        self.publish_at(self.clock.now(), kind);
    }

    fn publish_at(&self, at: HostNs, kind: EventKind) {
        self.shared.publish(&LinkEvent { at, gaps: self.decoder.gaps(), kind });
    }
}

/// The pressures that a command requests; none of one that vents the arm.
fn set_points(command: &Command) -> Option<SetPressures> {
    match command {
        Command::SetPressures(requested) => Some(requested.clone()),
        Command::Disarm => Some(SetPressures { pressures_pa: [].into_iter().collect(), valid_ms: 0 }),
        _ => None,
    }
}

/// The event of a part of the stream; replies go to the requests first.
fn event_kind(received: Received, requests: &mut Requests) -> EventKind {
    match received {
        Received::Message(message) => {
            if let Message::Reply(reply) = message {
                requests.replied(reply);
            }
            EventKind::Message(message)
        }
        Received::Undecoded(error) => EventKind::Undecoded(error),
        Received::Restarted => {
            requests.interrupt();
            EventKind::Restarted
        }
        Received::Mismatch(mismatch) => EventKind::Mismatch(mismatch),
    }
}
