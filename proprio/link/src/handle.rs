//! What the rest of the program holds of a link.

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::JoinHandle;
use std::time::Duration;

use telemetry::{Command, Counts, Hello};

use super::queue::Queue;
use super::requests::Answer;
use super::worker::Worker;
use super::{Event, LinkError, Mismatch, RequestError, Source, What};

/// Events that wait for one who listens: ten seconds of the full stream.
const ROOM: usize = 8192;

/// A link to a board, from its opening until it is dropped.
#[derive(Debug)]
pub struct Link {
    asks: Sender<Ask>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

/// What the thread is asked.
#[derive(Debug)]
pub(super) enum Ask {
    Request(Command, Answer),
    Stop,
}

/// What the thread and its holders both see.
#[derive(Debug, Default)]
pub(super) struct Shared {
    listeners: Mutex<Listeners>,
    state: Mutex<LinkState>,
}

#[derive(Debug, Default)]
struct Listeners {
    queues: Vec<Weak<Queue<Event>>>,
    /// Of a line that is gone for good: for those who come late.
    end: Option<Event>,
}

/// How a link is now.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinkState {
    /// Name of the line; `None` while it is gone.
    pub port: Option<String>,
    /// Whether the board has acknowledged a Ping since it started.
    pub greeted: bool,
    /// The board's last `Hello`.
    pub hello: Option<Hello>,
    /// Bytes received.
    pub bytes: u64,
    /// Frames received, damaged and lost.
    pub counts: Counts,
    /// How often the board has restarted since its first `Hello`.
    pub restarts: u32,
    /// How often the line was opened again.
    pub reopened: u32,
    /// In what board and host differ.
    pub mismatches: Vec<Mismatch>,
}

impl Link {
    /// Opens a line and starts the thread. `table` is the checksum that the board's table should have. The subscription
    /// hears everything from the first byte on.
    ///
    /// # Errors
    /// What keeps the line from being opened the first time.
    pub fn start(mut source: Box<dyn Source>, table: Option<u32>) -> Result<(Self, Subscription), LinkError> {
        let (name, transport) = source.open()?;
        let shared = Arc::new(Shared::default());
        let (asks, asked) = channel();
        shared.state().port = Some(name.clone());
        let subscription = shared.subscribe();
        let worker = Worker::new(source, table, asked, Arc::clone(&shared));
        let thread = std::thread::Builder::new().name("link".to_owned());
        let thread = thread.spawn(move || worker.run(name, transport)).map_err(LinkError::Thread)?;
        Ok((Self { asks, shared, thread: Some(thread) }, subscription))
    }

    /// Listens from now on.
    #[must_use]
    pub fn subscribe(&self) -> Subscription {
        self.shared.subscribe()
    }

    /// How the link is now.
    #[must_use]
    pub fn state(&self) -> LinkState {
        self.shared.state().clone()
    }

    /// Asks the board for something and waits until it is done. It is sent again until it is answered, and acts once.
    ///
    /// # Errors
    /// [`RequestError`]: refused, not answered within two seconds, or interrupted by a restart.
    pub fn request(&self, command: Command) -> Result<(), LinkError> {
        let (answer, answered) = channel();
        let sent = self.asks.send(Ask::Request(command, answer));
        let outcome = sent.ok().and_then(|()| answered.recv().ok()).unwrap_or(Err(RequestError::Interrupted));
        outcome.map_err(LinkError::Request)
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.asks.send(Ask::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn listeners(&self) -> MutexGuard<'_, Listeners> {
        self.listeners.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn subscribe(&self) -> Subscription {
        let queue = Arc::new(Queue::new(ROOM));
        let mut listeners = self.listeners();
        if let Some(end) = &listeners.end {
            queue.push(end.clone());
        }
        listeners.queues.push(Arc::downgrade(&queue));
        Subscription { queue }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, LinkState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hands an event to all who listen.
    pub(super) fn tell(&self, event: &Event) {
        let mut listeners = self.listeners();
        if matches!(event.what, What::Ended(_)) {
            listeners.end = Some(event.clone());
        }
        listeners.queues.retain(|queue| queue.upgrade().inspect(|queue| queue.push(event.clone())).is_some());
    }
}

/// One who listens to a link.
#[derive(Debug)]
pub struct Subscription {
    queue: Arc<Queue<Event>>,
}

impl Subscription {
    /// The next event, for which it waits as long as `wait`.
    #[must_use]
    pub fn next(&self, wait: Duration) -> Option<Event> {
        self.queue.pop(wait)
    }

    /// How many events were dropped so far because nobody took them in time.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }
}
