//! Handle of a link: its state, requests and subscriptions.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Weak};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use telemetry::Command;

use crate::error::LinkError;
use crate::event::EventKind;
use crate::history::ReceivedBytes;
use crate::relay::{Relay, RelayWorker};
use crate::requests::{Answer, RequestError, TIME_LIMIT};
use crate::shared::{LinkRequest, LinkState, SharedLink, Subscription};
use crate::source::{OpenedLine, Source};
use crate::worker::Worker;

/// Longest wait for a board to acknowledge a Ping: an emulated one may start slowly.
const CONNECTION: Duration = Duration::from_secs(10);

/// A link to a board, from its opening until it is dropped.
#[derive(Debug)]
pub struct Link {
    requests: Sender<LinkRequest>,
    shared: Arc<SharedLink>,
    thread: Option<JoinHandle<()>>,
    /// Identity of this handle: one handle drives the pressures at a time.
    identity: Arc<()>,
}

impl Link {
    /// Opens a line and starts the thread. `table` is the checksum that the board's table should have. The subscription
    /// receives all events from the first byte on.
    ///
    /// # Errors
    /// [`LinkError`] where the line cannot be opened the first time.
    pub fn start(mut source: Box<dyn Source>, table: Option<u32>) -> Result<(Self, Subscription), LinkError> {
        let opened = source.open()?;
        Self::start_on(source, Some(opened), table, SharedLink::default())
    }

    /// The same for a line that may not be there yet, and of which recordings may begin later: the link waits for the line, with
    /// the reason in its state, and holds the bytes since the last start of the board's estimator, up to 256 MB.
    ///
    /// # Errors
    /// [`LinkError`] where the line cannot be opened and cannot come back, as that of an emulated board.
    pub fn start_waiting(mut source: Box<dyn Source>, table: Option<u32>) -> Result<(Self, Subscription), LinkError> {
        let shared = SharedLink::default();
        shared.keep_history();
        match source.open() {
            Err(error) if source.can_reconnect() => {
                shared.state().waiting = Some(error.to_string());
                Self::start_on(source, None, table, shared)
            }
            opened => Self::start_on(source, Some(opened?), table, shared),
        }
    }

    fn start_on(
        source: Box<dyn Source>,
        opened: Option<OpenedLine>,
        table: Option<u32>,
        shared: SharedLink,
    ) -> Result<(Self, Subscription), LinkError> {
        let shared = Arc::new(shared);
        let (requests, received) = channel();
        shared.state().port = opened.as_ref().map(|(name, _)| name.clone());
        let subscription = shared.subscribe();
        let worker = Worker::new(source, table, received, Arc::clone(&shared));
        let link = Self::with_thread(requests, shared, move || worker.run(opened))?;
        Ok((link, subscription))
    }

    /// Starts on a line that another program has. `line` is its name where it is open, and `history` are the bytes that were
    /// received before those that are relayed, from the last start of the board's estimator on.
    ///
    /// # Errors
    /// [`LinkError::Thread`].
    pub fn start_relayed(
        relay: Box<dyn Relay>,
        line: Option<&str>,
        history: &[ReceivedBytes],
        table: Option<u32>,
    ) -> Result<(Self, Subscription), LinkError> {
        let shared = Arc::new(SharedLink::default());
        let (requests, received) = channel();
        let subscription = shared.subscribe();
        let worker = RelayWorker::new(relay, line, history, table, received, Arc::clone(&shared));
        let link = Self::with_thread(requests, shared, move || worker.run())?;
        Ok((link, subscription))
    }

    fn with_thread(
        requests: Sender<LinkRequest>,
        shared: Arc<SharedLink>,
        work: impl FnOnce() + Send + 'static,
    ) -> Result<Self, LinkError> {
        let thread = std::thread::Builder::new().name("link".to_owned()).spawn(work).map_err(LinkError::Thread)?;
        Ok(Self { requests, shared, thread: Some(thread), identity: Arc::default() })
    }

    /// A second handle of the link, for another thread: the link ends with the first one. While one handle drives the pressures,
    /// the requests of others to arm or to set them fail with [`RequestError::Driven`].
    #[must_use]
    pub fn second_handle(&self) -> Self {
        let (requests, shared) = (self.requests.clone(), Arc::clone(&self.shared));
        Self { requests, shared, thread: None, identity: Arc::default() }
    }

    /// Subscribes to all events from now on.
    #[must_use]
    pub fn subscribe(&self) -> Subscription {
        self.shared.subscribe()
    }

    /// Subscribes to all events from now on, and returns the bytes from the last start of the board's estimator until now;
    /// `None` where they are not all held.
    #[must_use]
    pub fn subscribe_with_history(&self) -> (Subscription, Option<Vec<ReceivedBytes>>) {
        self.shared.subscribe_with_history()
    }

    /// Current state of the link.
    #[must_use]
    pub fn state(&self) -> LinkState {
        self.shared.state().clone()
    }

    /// Waits until the board has acknowledged a Ping.
    ///
    /// # Errors
    /// [`LinkError::Ended`], and [`LinkError::Silent`] after ten seconds.
    pub fn wait_until_connected(&self) -> Result<(), LinkError> {
        let (start, events) = (Instant::now(), self.subscribe());
        while !self.state().is_connected {
            if let Some(EventKind::Ended(reason)) = events.next(Duration::from_millis(20)).map(|event| event.kind) {
                return Err(LinkError::Ended(reason));
            }
            if start.elapsed() >= CONNECTION {
                return Err(self.silent(CONNECTION));
            }
        }
        Ok(())
    }

    /// The error of a board that was silent for so long.
    #[must_use]
    pub fn silent(&self, time: Duration) -> LinkError {
        let state = self.state();
        if let Some(mismatch) = state.mismatches.first() {
            return LinkError::Ended(mismatch.to_string());
        }
        LinkError::Silent {
            port: state.port.unwrap_or_else(|| "the line".to_owned()),
            seconds: time.as_secs(),
            received: state.counts.received,
            damaged: state.counts.damaged,
        }
    }

    /// Sends a request to the board and waits until it is done. It is sent again until it is answered; the board executes
    /// it once.
    ///
    /// # Errors
    /// [`RequestError`]: refused, not answered within two seconds, or interrupted by a restart.
    pub fn request(&self, command: Command) -> Result<(), LinkError> {
        self.begin_request(command).wait()
    }

    /// Begins a request without waiting until it is done.
    pub fn begin_request(&self, command: Command) -> PendingRequest {
        let asker = Arc::new(());
        let answered = self.send(Arc::downgrade(&asker), command);
        PendingRequest { answered, _asker: asker }
    }

    /// As [`Link::request`] for an asker who may leave earlier: once it is dropped, the request is not sent any more.
    ///
    /// # Errors
    /// [`RequestError`].
    pub fn request_of(&self, asker: &Weak<()>, command: Command) -> Result<(), LinkError> {
        outcome(&self.send(asker.clone(), command))
    }

    fn send(&self, asker: Weak<()>, command: Command) -> Receiver<Result<(), RequestError>> {
        let (sender, answered) = channel();
        let answer = Answer { sender, asker, deadline: Instant::now() + TIME_LIMIT };
        // Without a thread the channel is closed, which is an interruption.
        let handle = Arc::downgrade(&self.identity);
        let _ = self.requests.send(LinkRequest::Command { command: Box::new(command), handle, answer });
        answered
    }
}

/// A request whose answer is not there yet. Once it is dropped, it is not sent any more.
#[derive(Debug)]
pub struct PendingRequest {
    answered: Receiver<Result<(), RequestError>>,
    _asker: Arc<()>,
}

impl PendingRequest {
    /// Waits until the request is done.
    ///
    /// # Errors
    /// As [`Link::request`].
    pub fn wait(self) -> Result<(), LinkError> {
        outcome(&self.answered)
    }
}

fn outcome(answered: &Receiver<Result<(), RequestError>>) -> Result<(), LinkError> {
    answered.recv().unwrap_or(Err(RequestError::Interrupted)).map_err(LinkError::Request)
}

impl Drop for Link {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            // It may have ended already.
            let _ = self.requests.send(LinkRequest::Stop);
            let _ = thread.join();
        }
    }
}
