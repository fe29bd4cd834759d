//! A line that another program has: it relays what it receives, and sends the requests of this one.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::Instant;

use proprio_session::{HostClock, HostNs};
use telemetry::{Command, SetPressures};

use crate::event::EventKind;
use crate::history::ReceivedBytes;
use crate::requests::{Answer, RequestError};
use crate::shared::{LinkRequest, SharedLink};
use crate::stream_publisher::StreamPublisher;

/// What a relay passes on.
#[derive(Debug, Clone, PartialEq)]
pub enum Relayed {
    /// The line of this name is open, or was opened again.
    Opened(String),
    /// The line was lost, for this reason; it may come back.
    Lost(String),
    /// The line is gone for good, for this reason.
    Ended(String),
    /// Received bytes, and the time of their arrival at the program that has the line.
    Bytes(HostNs, Arc<[u8]>),
    /// Any program has requested pressures, at this time.
    SetPoints(HostNs, SetPressures),
    /// Number of events that the relay has dropped because this program was too slow.
    Dropped(u64),
    /// Outcome of the request with this id.
    Answer(u32, Result<(), RequestError>),
}

/// A connection to the program that has a line.
pub trait Relay: Send {
    /// The next message; `None` where none comes within some milliseconds.
    ///
    /// # Errors
    /// The system's error when the program that has the line is gone.
    fn next(&mut self) -> io::Result<Option<Relayed>>;

    /// Sends a request, whose answer has its id.
    ///
    /// # Errors
    /// As [`next`](Self::next).
    fn request(&mut self, id: u32, command: &Command) -> io::Result<()>;
}

/// State of the thread of a relayed line.
pub(super) struct RelayWorker {
    relay: Box<dyn Relay>,
    received: Receiver<LinkRequest>,
    shared: Arc<SharedLink>,
    clock: HostClock,
    stream: StreamPublisher,
    last_id: u32,
    /// Requests without an answer yet, with their ids.
    waiting: VecDeque<(u32, Answer)>,
}

/// Reason of the thread's end.
enum End {
    LinkDropped,
    Line(String),
}

impl From<io::Error> for End {
    fn from(error: io::Error) -> Self {
        Self::Line(error.to_string())
    }
}

impl RelayWorker {
    pub fn new(
        relay: Box<dyn Relay>,
        line: Option<&str>,
        history: &[ReceivedBytes],
        table: Option<u32>,
        received: Receiver<LinkRequest>,
        shared: Arc<SharedLink>,
    ) -> Self {
        let (clock, mut stream) = (HostClock::new(), StreamPublisher::new(Arc::clone(&shared), table));
        if let Some(line) = line {
            stream.join(clock.now(), line, history);
        }
        Self { relay, received, shared, clock, stream, last_id: 0, waiting: VecDeque::new() }
    }

    /// Works until the link is dropped or its line is gone for good.
    pub fn run(mut self) {
        loop {
            match self.step() {
                Ok(()) => {}
                Err(End::LinkDropped) => return,
                Err(End::Line(reason)) => {
                    self.shared.state().port = None;
                    return self.stream.publish(self.clock.now(), EventKind::Ended(reason));
                }
            }
        }
    }

    fn step(&mut self) -> Result<(), End> {
        self.take_requests()?;
        if let Some(relayed) = self.relay.next()? {
            self.take(relayed)?;
        }
        let now = Instant::now();
        self.waiting.retain(|(_, answer)| {
            let is_awaited = answer.is_awaited(now);
            if !is_awaited {
                answer.send(Err(RequestError::NoAnswer));
            }
            is_awaited
        });
        Ok(())
    }

    fn take_requests(&mut self) -> Result<(), End> {
        loop {
            match self.received.try_recv() {
                Ok(LinkRequest::Command { command, answer, .. }) => {
                    if !answer.is_awaited(Instant::now()) {
                        answer.send(Err(RequestError::NoAnswer));
                        continue;
                    }
                    self.last_id = self.last_id.wrapping_add(1);
                    self.relay.request(self.last_id, &command)?;
                    self.waiting.push_back((self.last_id, answer));
                }
                Ok(LinkRequest::Stop) | Err(TryRecvError::Disconnected) => return Err(End::LinkDropped),
                Err(TryRecvError::Empty) => return Ok(()),
            }
        }
    }

    fn take(&mut self, relayed: Relayed) -> Result<(), End> {
        match relayed {
            Relayed::Opened(name) => {
                if self.shared.state().port.is_none() {
                    self.stream.opened(self.clock.now(), &name);
                }
            }
            Relayed::Lost(reason) => {
                let mut state = self.shared.state();
                (state.port, state.is_connected) = (None, false);
                drop(state);
                self.stream.publish(self.clock.now(), EventKind::Lost(reason));
            }
            Relayed::Ended(reason) => return Err(End::Line(reason)),
            Relayed::Bytes(at, bytes) => self.stream.bytes(at, &bytes, |_| {}),
            Relayed::SetPoints(at, requested) => self.stream.publish(at, EventKind::SetPoints(requested)),
            Relayed::Dropped(events) => self.shared.add_dropped(events),
            Relayed::Answer(id, outcome) => {
                // One that was given up has no asker any more.
                if let Some(place) = self.waiting.iter().position(|(waiting, _)| *waiting == id)
                    && let Some((_, answer)) = self.waiting.remove(place)
                {
                    self.shared.state().is_connected |= outcome.is_ok();
                    answer.send(outcome);
                }
            }
        }
        Ok(())
    }
}
