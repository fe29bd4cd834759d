//! The link's thread.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};

use proprio_session::{HostClock, HostNs};
use telemetry::Message;

use super::handle::{Ask, Shared};
use super::intake::{Intake, Taken};
use super::requests::Requests;
use super::{Event, Source, Transport, What};

/// Time between two looks for a board that is gone.
const LOOK: Duration = Duration::from_millis(300);

/// What the thread owns.
pub(super) struct Worker {
    source: Box<dyn Source>,
    asked: Receiver<Ask>,
    shared: Arc<Shared>,
    clock: HostClock,
    intake: Intake,
    requests: Requests,
}

/// Its holder has dropped the link.
struct StopReason;

impl Worker {
    pub fn new(source: Box<dyn Source>, table: Option<u32>, asked: Receiver<Ask>, shared: Arc<Shared>) -> Self {
        let (clock, intake, requests) = (HostClock::new(), Intake::new(table), Requests::default());
        Self { source, asked, shared, clock, intake, requests }
    }

    /// Works until the link is dropped or its line is gone for good.
    pub fn run(mut self, mut name: String, mut transport: Box<dyn Transport>) {
        loop {
            let Ok(reason) = self.work(&name, transport.as_mut()) else { return };
            drop(transport);
            self.requests.interrupt();
            if !self.source.comes_back() {
                return self.tell(What::Ended(reason));
            }
            self.tell(What::Lost(reason));
            match self.open_again() {
                Ok(opened) => (name, transport) = opened,
                Err(StopReason) => return,
            }
        }
    }

    /// Works on an open line until it is lost, and says why.
    fn work(&mut self, name: &str, transport: &mut dyn Transport) -> Result<String, StopReason> {
        self.intake.open();
        self.shared.state().port = Some(name.to_owned());
        self.tell(What::Opened(name.to_owned()));
        let mut buffer = [0; 4096];
        loop {
            self.take_asks()?;
            let due = self.requests.due(Instant::now());
            let sent = due.map_or(Ok(()), |bytes| transport.write(&bytes));
            match sent.and_then(|()| transport.read(&mut buffer)) {
                Ok(0) => {}
                Ok(count) => self.take(&buffer[..count]),
                Err(error) => {
                    self.shared.state().port = None;
                    return Ok(format!("{name}: {error}"));
                }
            }
        }
    }

    fn open_again(&mut self) -> Result<(String, Box<dyn Transport>), StopReason> {
        loop {
            std::thread::sleep(LOOK);
            self.take_asks()?;
            // Nobody is there to answer.
            self.requests.interrupt();
            if let Ok(opened) = self.source.open() {
                self.shared.state().reopened += 1;
                return Ok(opened);
            }
        }
    }

    fn take_asks(&mut self) -> Result<(), StopReason> {
        loop {
            match self.asked.try_recv() {
                Ok(Ask::Request(command, answer)) => self.requests.push(command, answer),
                Ok(Ask::Stop) | Err(TryRecvError::Disconnected) => return Err(StopReason),
                Err(TryRecvError::Empty) => return Ok(()),
            }
        }
    }

    fn take(&mut self, bytes: &[u8]) {
        let at = self.clock.now();
        self.shared.tell(&Event { at, what: What::Bytes(bytes.into()) });
        let Self { intake, requests, shared, .. } = self;
        for byte in bytes {
            intake.push(*byte, |taken| shared.tell(&event(at, taken, requests)));
        }
        let mut state = shared.state();
        state.bytes += bytes.len() as u64;
        state.counts = intake.counts();
        state.greeted = requests.greeted();
        state.restarts = intake.restarts();
        if state.hello.as_ref() != intake.hello() {
            state.hello = intake.hello().cloned();
        }
        if state.mismatches.len() != intake.mismatches().len() {
            state.mismatches = intake.mismatches().to_vec();
        }
    }

    fn tell(&self, what: What) {
        self.shared.tell(&Event { at: self.clock.now(), what });
    }
}

/// What came, as an event; requests see it first.
fn event(at: HostNs, taken: Taken, requests: &mut Requests) -> Event {
    let what = match taken {
        Taken::Message(message) => {
            if let Message::Reply(reply) = message {
                requests.replied(reply);
            }
            What::Message(message)
        }
        Taken::Undecoded(error) => What::Undecoded(error),
        Taken::Restarted => {
            requests.interrupt();
            What::Restarted
        }
        Taken::Mismatch(mismatch) => What::Mismatch(mismatch),
    };
    Event { at, what }
}
