//! The link's thread.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use proprio_session::HostClock;
use telemetry::{Command, Message, SetPressures};

use crate::control::Control;
use crate::event::EventKind;
use crate::requests::{RequestError, Requests};
use crate::shared::{LinkRequest, SharedLink};
use crate::source::{OpenedLine, Source, Transport};
use crate::stream_decoder::Received;
use crate::stream_publisher::StreamPublisher;

/// Time between two attempts to open a line that is gone.
const RETRY_PERIOD: Duration = Duration::from_millis(300);

/// State of the thread.
pub(super) struct Worker {
    source: Box<dyn Source>,
    received: Receiver<LinkRequest>,
    shared: Arc<SharedLink>,
    clock: HostClock,
    stream: StreamPublisher,
    requests: Requests,
    control: Control,
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
        let stream = StreamPublisher::new(Arc::clone(&shared), table);
        let (clock, requests, control) = (HostClock::new(), Requests::default(), Control::default());
        Self { source, received, shared, clock, stream, requests, control }
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
        self.stream.opened(self.clock.now(), name);
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
                Ok(LinkRequest::Command { command, handle, answer }) => {
                    if !self.control.admits(&handle, &command, Instant::now()) {
                        answer.send(Err(RequestError::Driven));
                        continue;
                    }
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
        let Self { stream, requests, shared, clock, .. } = self;
        stream.bytes(clock.now(), &bytes.into(), |part| match part {
            Received::Message(Message::Reply(reply)) => requests.replied(*reply),
            Received::Restarted => requests.interrupt(),
            _ => {}
        });
        requests.set_version(stream.version());
        shared.state().is_connected = requests.is_connected();
    }

    fn publish(&self, kind: EventKind) {
        self.stream.publish(self.clock.now(), kind);
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
