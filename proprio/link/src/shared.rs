//! State and event queues that the link's thread shares with its handle.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use telemetry::{Command, Counts, Hello};

use crate::event::{EventKind, LinkEvent, Mismatch};
use crate::history::{History, ReceivedBytes};
use crate::queue::Queue;
use crate::requests::Answer;

/// Capacity of a subscription's queue, events: ten seconds of the full stream.
const CAPACITY: usize = 8192;

/// A request to the link's thread.
#[derive(Debug)]
pub(super) enum LinkRequest {
    /// Send a command to the board.
    Command {
        command: Box<Command>,
        /// Identity of the handle that asks.
        handle: Weak<()>,
        answer: Answer,
    },
    /// End.
    Stop,
}

/// State and subscribers of a link.
#[derive(Debug, Default)]
pub(super) struct SharedLink {
    subscribers: Mutex<Subscribers>,
    state: Mutex<LinkState>,
}

#[derive(Debug, Default)]
struct Subscribers {
    queues: Vec<Weak<Queue<LinkEvent>>>,
    /// Where recordings may begin later than the link.
    history: Option<History>,
    /// The last event of a line that is gone for good, for later subscribers.
    end: Option<LinkEvent>,
}

/// Current state of a link.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LinkState {
    /// Name of the line; `None` while it is gone.
    pub port: Option<String>,
    /// Reason why no line could be opened yet; `None` once one was.
    pub waiting: Option<String>,
    /// True once the board has acknowledged a Ping since its start; of a relayed line, any request of this link.
    pub is_connected: bool,
    /// The board's last `Hello`.
    pub hello: Option<Hello>,
    /// Bytes received.
    pub bytes: u64,
    /// Frames received, damaged and lost.
    pub counts: Counts,
    /// Restarts of the board since its first `Hello`.
    pub restarts: u32,
    /// Times that the line was opened again.
    pub reopened: u32,
    /// Differences between board and host.
    pub mismatches: Vec<Mismatch>,
}

impl SharedLink {
    fn subscribers(&self) -> MutexGuard<'_, Subscribers> {
        self.subscribers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Holds a history from now on.
    pub fn keep_history(&self) {
        self.subscribers().history = Some(History::new());
    }

    /// Adds a subscriber.
    pub fn subscribe(&self) -> Subscription {
        self.subscribers().add()
    }

    /// Adds a subscriber, and returns the bytes from the last start of the board's estimator to its first event.
    pub fn subscribe_with_history(&self) -> (Subscription, Option<Vec<ReceivedBytes>>) {
        let mut subscribers = self.subscribers();
        (subscribers.add(), subscribers.history.as_ref().and_then(History::whole))
    }

    /// Counts events that were dropped before they came to this link.
    pub fn add_dropped(&self, events: u64) {
        let subscribers = self.subscribers();
        subscribers.queues.iter().filter_map(Weak::upgrade).for_each(|queue| queue.add_dropped(events));
    }

    /// The state, locked.
    pub fn state(&self) -> MutexGuard<'_, LinkState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts an event into the queue of every subscriber.
    pub fn publish(&self, event: &LinkEvent) {
        let mut subscribers = self.subscribers();
        if matches!(event.kind, EventKind::Ended(_)) {
            subscribers.end = Some(event.clone());
        }
        if let Some(history) = &mut subscribers.history {
            history.take(event);
        }
        subscribers.queues.retain(|queue| queue.upgrade().inspect(|queue| queue.push(event.clone())).is_some());
    }
}

impl Subscribers {
    fn add(&mut self) -> Subscription {
        let queue = Arc::new(Queue::new(CAPACITY));
        if let Some(end) = &self.end {
            queue.push(end.clone());
        }
        self.queues.push(Arc::downgrade(&queue));
        Subscription { queue }
    }
}

/// A subscription to the events of a link.
#[derive(Debug)]
pub struct Subscription {
    queue: Arc<Queue<LinkEvent>>,
}

impl Subscription {
    /// The next event; `None` where none comes within `wait`.
    #[must_use]
    pub fn next(&self, wait: Duration) -> Option<LinkEvent> {
        self.queue.pop(wait)
    }

    /// Number of events that were dropped because they were not taken in time.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.queue.dropped()
    }
}
