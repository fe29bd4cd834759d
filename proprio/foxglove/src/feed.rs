//! The messages of the link's events, for all clients.

use std::convert::Infallible;
use std::mem;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use calibration_tables::ArmFile;
use proprio_link::Subscription;
use proprio_session::recording::{Channel, MessageInfo, MessageSink};

use crate::channels;
use crate::live_messages::LiveMessages;
use crate::stream::{Stream, StreamMessage};

/// Time for which events are gathered, two ticks of the board: each wake-up costs more than the work on a message.
const PERIOD: Duration = Duration::from_millis(20);
/// The same while there is no client.
const IDLE_PERIOD: Duration = Duration::from_millis(50);

/// State of the thread.
pub struct Feed {
    messages: LiveMessages,
    sink: StreamSink,
}

impl Feed {
    pub fn new(stream: Arc<Stream>, table: Option<&ArmFile>) -> Self {
        Self { messages: LiveMessages::new(table), sink: StreamSink { stream, batch: Vec::new() } }
    }

    /// Works until `stop` is set.
    pub fn run(mut self, events: &Subscription, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            thread::sleep(if self.sink.stream.has_clients() { PERIOD } else { IDLE_PERIOD });
            while let Some(event) = events.next(Duration::ZERO) {
                let Ok(()) = self.messages.take(&event, &mut self.sink);
            }
            self.sink.stream.send(mem::take(&mut self.sink.batch));
        }
    }
}

/// The stream as a destination of messages.
struct StreamSink {
    stream: Arc<Stream>,
    /// Messages since the last batch was sent.
    batch: Vec<StreamMessage>,
}

impl MessageSink for StreamSink {
    type Error = Infallible;

    fn message(
        &mut self,
        channel: &'static Channel,
        info: MessageInfo,
        encode: impl FnOnce() -> Vec<u8>,
    ) -> Result<(), Infallible> {
        if let Some(channel) = channels::number(channel).filter(|channel| self.stream.is_received(*channel)) {
            self.batch.push(StreamMessage { channel, at: info.at, data: encode() });
        }
        Ok(())
    }
}
