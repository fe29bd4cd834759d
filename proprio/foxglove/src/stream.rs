//! State that the feed and the clients share: the queue of messages, and the number of subscriptions to each channel.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use proprio_session::{HostClock, HostNs};
use tokio::sync::broadcast;

use crate::channels;

/// Capacity of a client's queue, batches: two seconds at least. A slower client loses the oldest.
const CAPACITY: usize = 128;

/// Messages that are sent together.
pub type Batch = Arc<[StreamMessage]>;

/// A message for all clients that have subscribed to its channel.
#[derive(Debug)]
pub struct StreamMessage {
    /// Number of the channel.
    pub channel: usize,
    /// Time of its arrival.
    pub at: HostNs,
    /// The message in CDR.
    pub data: Vec<u8>,
}

/// State of the stream.
#[derive(Debug)]
pub struct Stream {
    batches: broadcast::Sender<Batch>,
    subscriptions: [AtomicU32; channels::COUNT],
    /// Identity of this run of the program.
    pub session_id: String,
}

impl Stream {
    pub fn new() -> Self {
        let (batches, _) = broadcast::channel(CAPACITY);
        let session_id = HostClock::new().now().0.to_string();
        Self { batches, subscriptions: Default::default(), session_id }
    }

    pub fn has_clients(&self) -> bool {
        self.batches.receiver_count() > 0
    }

    /// True where a client receives the messages of a channel.
    pub fn is_received(&self, channel: usize) -> bool {
        self.subscriptions[channel].load(Ordering::Relaxed) > 0
    }

    /// Puts messages into the queue of each client.
    pub fn send(&self, messages: Vec<StreamMessage>) {
        if !messages.is_empty() {
            // The last client may have left.
            let _ = self.batches.send(messages.into());
        }
    }

    /// The queue of a new client.
    pub fn batches(&self) -> broadcast::Receiver<Batch> {
        self.batches.subscribe()
    }

    pub fn subscribed(&self, channel: usize) {
        self.subscriptions[channel].fetch_add(1, Ordering::Relaxed);
    }

    pub fn unsubscribed(&self, channel: usize) {
        self.subscriptions[channel].fetch_sub(1, Ordering::Relaxed);
    }
}
